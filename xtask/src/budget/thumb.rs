//! Thumb code, read as far as the budget needs it: what takes stack, what calls.
//!
//! In: the code of one function. Out: [`Step`]s in the order of the addresses. Everything else is passed over.

/// What an instruction means to the budget.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// The stack grows by so many bytes.
    Takes(u64),
    /// The stack grows by a number that stands in a register.
    TakesUnknown,
    /// A call: the caller's stack stays.
    Calls(u64),
    /// A jump: into the same function, or into another one in place of a return.
    Jumps(u64),
    /// A call of an address in a register.
    CallsUnknown,
}

/// Instructions of `code`, which lies at `at`.
pub fn steps(code: &[u8], at: u64) -> Vec<Step> {
    let halfwords: Vec<u16> = code.chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]])).collect();
    let mut steps = Vec::new();
    let mut register = [0; 16];
    let mut index = 0;
    while let Some(&first) = halfwords.get(index) {
        let here = at + 2 * index as u64;
        let wide = first >= 0xE800;
        let second = halfwords.get(index + 1).copied().unwrap_or(0);
        if wide {
            load_constant(first, second, &mut register);
            steps.extend(of_32_bits(first, second, here, &register));
        } else {
            steps.extend(of_16_bits(first, here));
        }
        index += if wide { 2 } else { 1 };
    }
    steps
}

fn of_16_bits(word: u16, here: u64) -> Option<Step> {
    let jump = |offset: i64| Some(Step::Jumps(here.wrapping_add_signed(4 + offset)));
    match word {
        // PUSH
        0xB400..=0xB5FF => Some(Step::Takes(4 * u64::from((word & 0x1FF).count_ones()))),
        // SUB SP
        0xB080..=0xB0FF => Some(Step::Takes(4 * u64::from(word & 0x7F))),
        // BLX register
        _ if word & 0xFF87 == 0x4780 => Some(Step::CallsUnknown),
        // BX register, but for BX LR
        _ if word & 0xFF87 == 0x4700 && word != 0x4770 => Some(Step::CallsUnknown),
        // B
        0xE000..=0xE7FF => jump(signed(u32::from(word & 0x7FF) << 1, 12)),
        // B with a condition
        0xD000..=0xDDFF => jump(signed(u32::from(word & 0xFF) << 1, 9)),
        _ => None,
    }
}

fn of_32_bits(first: u16, second: u16, here: u64, register: &[u64; 16]) -> Option<Step> {
    let to = |offset: i64| here.wrapping_add_signed(4 + offset);
    match (first, second) {
        // PUSH.W
        (0xE92D, _) => Some(Step::Takes(4 * u64::from(second.count_ones()))),
        // STR register, [SP, #-n]!
        (0xF84D, _) if second & 0x0F00 == 0x0D00 => Some(Step::Takes(u64::from(second & 0xFF))),
        // STRD register, register, [SP, #-n]!
        (0xE96D, _) => Some(Step::Takes(4 * u64::from(second & 0xFF))),
        // VPUSH of doubles and of singles: the low byte counts words
        (0xED2D | 0xED6D, _) if matches!(second & 0x0F00, 0x0A00 | 0x0B00) => {
            Some(Step::Takes(4 * u64::from(second & 0xFF)))
        }
        // SUB.W SP, SP, #modified constant
        (0xF1AD | 0xF5AD, _) if second & 0x0F00 == 0x0D00 => Some(Step::Takes(expand(first, second))),
        // SUBW SP, SP, #constant
        (0xF2AD | 0xF6AD, _) if second & 0x0F00 == 0x0D00 => {
            Some(Step::Takes(u64::from((first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 0xFF)))
        }
        // SUB.W SP, SP, register
        (0xEBAD, _) if second & 0x0F00 == 0x0D00 => match register.get(usize::from(second & 0xF)) {
            Some(&bytes) if bytes > 0 => Some(Step::Takes(bytes)),
            _ => Some(Step::TakesUnknown),
        },
        // BL, B.W
        _ if first & 0xF800 == 0xF000 && second & 0xD000 == 0xD000 => Some(Step::Calls(to(far(first, second)))),
        _ if first & 0xF800 == 0xF000 && second & 0xD000 == 0x9000 => Some(Step::Jumps(to(far(first, second)))),
        // B.W with a condition; 111x as a condition is another instruction.
        _ if first & 0xF800 == 0xF000 && second & 0xD000 == 0x8000 && first & 0x0380 != 0x0380 => {
            let (first, second) = (u32::from(first), u32::from(second));
            let offset = (first >> 10 & 1) << 20
                | (second >> 11 & 1) << 19
                | (second >> 13 & 1) << 18
                | (first & 0x3F) << 12
                | (second & 0x7FF) << 1;
            Some(Step::Jumps(to(signed(offset, 21))))
        }
        _ => None,
    }
}

/// Remembers constants for a stack that is taken through a register: `MOV.W` and `MOVW`.
fn load_constant(first: u16, second: u16, register: &mut [u64; 16]) {
    let value = match first {
        0xF04F | 0xF44F => expand(first, second),
        _ if first & 0xFBF0 == 0xF240 => {
            u64::from((first & 0xF) << 12 | (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 0xFF)
        }
        _ => return,
    };
    if let Some(register) = register.get_mut(usize::from(second >> 8 & 0xF)) {
        *register = value;
    }
}

/// Offset of `BL` and `B.W`, from the instruction's end.
fn far(first: u16, second: u16) -> i64 {
    let (first, second) = (u32::from(first), u32::from(second));
    let sign = first >> 10 & 1;
    let bit = |j: u32| !(j ^ sign) & 1;
    let (i1, i2) = (bit(second >> 13 & 1), bit(second >> 11 & 1));
    let bits = sign << 24 | i1 << 23 | i2 << 22 | (first & 0x3FF) << 12 | (second & 0x7FF) << 1;
    signed(bits, 25)
}

fn signed(value: u32, bits: u32) -> i64 {
    i64::from((value << (32 - bits)).cast_signed() >> (32 - bits))
}

/// A modified immediate constant: a byte, or a byte with its top bit set rotated to the right.
fn expand(first: u16, second: u16) -> u64 {
    let rule = u32::from((first >> 10 & 1) << 4 | (second >> 12 & 7) << 1 | second >> 7 & 1);
    let byte = u32::from(second & 0xFF);
    u64::from(match rule {
        0 | 1 => byte,
        2 | 3 => byte << 16 | byte,
        4 | 5 => byte << 24 | byte << 8,
        6 | 7 => byte * 0x0101_0101,
        _ => (byte & 0x7F | 0x80).rotate_right(rule),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(halfwords: &[u16]) -> Vec<Step> {
        let code: Vec<u8> = halfwords.iter().flat_map(|word| word.to_le_bytes()).collect();
        steps(&code, 0x0800_0000)
    }

    #[test]
    fn stack_is_taken_as_the_assembler_encodes_it() {
        // push {r4, r5, r6, r7, lr}; sub sp, #16
        assert_eq!(of(&[0xB5F0, 0xB084]), [Step::Takes(20), Step::Takes(16)]);
        // push.w {r4-r11, lr}; vpush {d8-d15}; sub.w sp, sp, #1024
        let wide = [0xE92D, 0x4FF0, 0xED2D, 0x8B10, 0xF5AD, 0x6D80];
        assert_eq!(of(&wide), [Step::Takes(36), Step::Takes(64), Step::Takes(1024)]);
        // subw sp, sp, #2052; str lr, [sp, #-8]!
        assert_eq!(of(&[0xF6AD, 0x0D04, 0xF84D, 0xED08]), [Step::Takes(2052), Step::Takes(8)]);
        // movw r4, #4100; sub.w sp, sp, r4
        assert_eq!(of(&[0xF241, 0x0404, 0xEBAD, 0x0D04]), [Step::Takes(4100)]);
    }

    #[test]
    fn calls_and_jumps_are_decoded_with_their_targets() {
        // bl . ; bl .+4 ; b.w .
        assert_eq!(of(&[0xF7FF, 0xFFFE]), [Step::Calls(0x0800_0000)]);
        assert_eq!(of(&[0xF000, 0xF800]), [Step::Calls(0x0800_0004)]);
        assert_eq!(of(&[0xF7FF, 0xBFFE]), [Step::Jumps(0x0800_0000)]);
        // b . ; beq .+4 ; bne.w .
        assert_eq!(of(&[0xE7FE]), [Step::Jumps(0x0800_0000)]);
        assert_eq!(of(&[0xD000]), [Step::Jumps(0x0800_0004)]);
        assert_eq!(of(&[0xF47F, 0xAFFE]), [Step::Jumps(0x0800_0000)]);
        // blx r3; bx lr is a return
        assert_eq!(of(&[0x4798, 0x4770]), [Step::CallsUnknown]);
        // The second half of a 32-bit instruction is not read as one of its own: ldr.w r0, [r1, #0x586]
        assert_eq!(of(&[0xF8D1, 0x0586, 0xB580]), [Step::Takes(8)]);
    }
}
