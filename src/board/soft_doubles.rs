//! The functions that the compiler calls for doubles. The linker takes these before the compiler's, whose sums and
//! products are twice as slow, whose quotient is faster and twice as large, and whose comparisons and conversions are
//! three times as large.
//!
//! Names and calls are those of Arm's run-time ABI (RTABI, tables 2, 3, 6 to 8): the bits of a double in two core
//! registers, also where there are registers for floats. Sums and products are written for usual numbers, with a first
//! bit and a result that has one; the others go to `rundown::onboard::doubles`, against which all of them are held
//! (`cargo xtask budget`, image `filter-step`), and so do quotients and conversions, which are rare.

use core::arch::naked_asm;
use rundown::onboard::doubles;

extern "aapcs" fn unusual_sum(a: u64, b: u64) -> u64 {
    doubles::add(a, b)
}

extern "aapcs" fn unusual_product(a: u64, b: u64) -> u64 {
    doubles::multiply(a, b)
}

/// a - b: the sum with the other sign.
// SAFETY: the name belongs to this function. Goes on in `__aeabi_dadd` with its arguments where they have been.
#[unsafe(no_mangle)]
#[unsafe(naked)]
extern "aapcs" fn __aeabi_dsub(a: u64, b: u64) -> u64 {
    naked_asm!("eor r3, r3, #0x80000000", "b {add}", add = sym __aeabi_dadd)
}

/// a + b.
// SAFETY: the name belongs to this function. It writes r0 to r3 and r12, which are its own, and r4 to r7, which it
// gives back.
#[unsafe(no_mangle)]
#[unsafe(naked)]
pub(crate) extern "aapcs" fn __aeabi_dadd(a: u64, b: u64) -> u64 {
    naked_asm!(
        "push {{r4, r5, r6, r7, lr}}",
        // The larger one into r1:r0. Without their signs, which go to the left.
        "lsl r4, r1, #1",
        "lsl r5, r3, #1",
        "cmp r4, r5",
        "it eq",
        "cmpeq r0, r2",
        "bhs 1f",
        "mov r6, r0",
        "mov r0, r2",
        "mov r2, r6",
        "mov r6, r1",
        "mov r1, r3",
        "mov r3, r6",
        "mov r6, r4",
        "mov r4, r5",
        "mov r5, r6",
        // The larger one is infinite or no number, or the smaller one has no first bit.
        "1:",
        "cmn r4, #0x200000",
        "bcs 9f",
        "lsrs r5, r5, #21",
        "beq 4f",
        // r12: sign and exponent. r5: how far the exponents are apart. lr: whether the signs differ.
        "lsr r12, r1, #20",
        "rsb r5, r5, r4, lsr #21",
        "eor lr, r1, r3",
        // Mantissas with their first bits: 20 in the upper word.
        "bfc r1, #20, #12",
        "orr r1, r1, #0x100000",
        "bfc r3, #20, #12",
        "orr r3, r3, #0x100000",
        // The smaller one down to the exponent of the larger one; what falls out goes into r7.
        "rsbs r6, r5, #32",
        "bmi 5f",
        "lsl r7, r2, r6",
        "lsr r2, r2, r5",
        "lsl r6, r3, r6",
        "orr r2, r2, r6",
        "lsr r3, r3, r5",
        "2:",
        "cmp lr, #0",
        "bmi 6f",
        "adds r0, r0, r2",
        "adc r1, r1, r3",
        "tst r1, #0x200000",
        "bne 7f",
        // To the nearest: r7 is a half, more or less; a tie asks the last bit. The first bit adds one to the exponent.
        "3:",
        "sub r12, r12, #1",
        "cmp r7, #0x80000000",
        "it eq",
        "lsrseq r7, r0, #1",
        "adcs r0, r0, #0",
        "adc r1, r1, r12, lsl #20",
        "pop {{r4, r5, r6, r7, pc}}",
        // More than a word apart.
        "5:",
        "subs r5, r5, #32",
        "cmp r5, #22",
        "itt hi",
        "movhi r7, #0",
        "bhi 3b",
        "rsb r6, r5, #32",
        "lsl r7, r3, r6",
        "lsr r4, r2, r5",
        "orr r7, r7, r4",
        // Above the last bit, which a sum with one more place shifts out.
        "lsls r4, r2, r6",
        "it ne",
        "orrne r7, r7, #2",
        "lsr r2, r3, r5",
        "mov r3, #0",
        "b 2b",
        // Of different signs.
        "6:",
        "rsbs r7, r7, #0",
        "sbcs r0, r0, r2",
        "sbc r1, r1, r3",
        "tst r1, #0x100000",
        "bne 3b",
        "ubfx r4, r12, #0, #11",
        "cmp r4, #1",
        "beq 8f",
        "adds r7, r7, r7",
        "adcs r0, r0, r0",
        "adc r1, r1, r1",
        "sub r12, r12, #1",
        "sub r4, r4, #1",
        "tst r1, #0x100000",
        "bne 3b",
        // More places are free only where the exponents are one apart at most: all bits are there. Up by r6, but not
        // below the least exponent.
        "8:",
        "orrs r5, r0, r1",
        "beq 0f",
        "clz r6, r1",
        "cmp r1, #0",
        "itt eq",
        "clzeq r6, r0",
        "addeq r6, r6, #32",
        "sub r6, r6, #11",
        "cmp r6, r4",
        "it hs",
        "subhs r6, r4, #1",
        "sub r12, r12, r6",
        "cmp r6, #32",
        "ittt hs",
        "movhs r1, r0",
        "movhs r0, #0",
        "subhs r6, r6, #32",
        "rsb r5, r6, #32",
        "lsl r1, r1, r6",
        "lsr r5, r0, r5",
        "orr r1, r1, r5",
        "lsl r0, r0, r6",
        "b 3b",
        // One place more.
        "7:",
        "lsrs r1, r1, #1",
        "rrxs r0, r0",
        "rrx r7, r7",
        "add r12, r12, #1",
        "mvns r4, r12, lsl #21",
        "lsrs r4, r4, #21",
        "bne 3b",
        "mov r0, #0",
        "lsl r1, r12, #20",
        "pop {{r4, r5, r6, r7, pc}}",
        // 0 and something: sums begin so.
        "4:",
        "orrs r5, r2, r3, lsl #1",
        "bne 9f",
        "cmp r4, #0",
        "beq 9f",
        "0:",
        "pop {{r4, r5, r6, r7, pc}}",
        // r0 to r3 still have both.
        "9:",
        "pop {{r4, r5, r6, r7, lr}}",
        "b {unusual}",
        unusual = sym unusual_sum,
    )
}

/// a b.
// SAFETY: the name belongs to this function. It writes r0 to r3 and r12, which are its own, and r4 to r7, which it
// gives back.
#[unsafe(no_mangle)]
#[unsafe(naked)]
extern "aapcs" fn __aeabi_dmul(a: u64, b: u64) -> u64 {
    naked_asm!(
        "push {{r4, r5, r6, r7, lr}}",
        // Exponents into r4 and r5; neither 0 nor that of what is infinite or no number.
        "movw r12, #0x7FF",
        "ands r4, r12, r1, lsr #20",
        "ittt ne",
        "andsne r5, r12, r3, lsr #20",
        "cmpne r4, r12",
        "cmpne r5, r12",
        "beq 9f",
        // Far from the least and the largest exponent of a result.
        "add r4, r4, r5",
        "subw r5, r4, #1025",
        "cmp r5, #0x7F0",
        "bhs 9f",
        "eor r12, r1, r3",
        // a with its first bit as the 64th, b as the 53rd: the upper half of the product has 52 or 53 bits.
        "lsl r1, r1, #11",
        "orr r1, r1, #0x80000000",
        "orr r1, r1, r0, lsr #21",
        "lsl r0, r0, #11",
        "bfc r3, #20, #12",
        "orr r3, r3, #0x100000",
        // Word by word, from the lowest: r5, r6, r7, lr.
        "umull r5, r6, r0, r2",
        "mov r7, #0",
        "mov lr, #0",
        "umaal r6, r7, r0, r3",
        "umaal r6, lr, r1, r2",
        "umaal r7, lr, r1, r3",
        // Of the lowest it counts whether there is any.
        "cmp r5, #0",
        "it ne",
        "orrne r6, r6, #1",
        "tst lr, #0x100000",
        "bne 1f",
        "adds r6, r6, r6",
        "adcs r7, r7, r7",
        "adc lr, lr, lr",
        "sub r4, r4, #1",
        "1:",
        "subw r4, r4, #1023",
        "and r12, r12, #0x80000000",
        // To the nearest, as in a sum.
        "cmp r6, #0x80000000",
        "it eq",
        "lsrseq r6, r7, #1",
        "adcs r0, r7, #0",
        "adc r1, lr, r4, lsl #20",
        "orr r1, r1, r12",
        "pop {{r4, r5, r6, r7, pc}}",
        "9:",
        "pop {{r4, r5, r6, r7, lr}}",
        "b {unusual}",
        unusual = sym unusual_product,
    )
}

/// a / b.
// SAFETY: the name belongs to this function.
#[unsafe(no_mangle)]
extern "aapcs" fn __aeabi_ddiv(a: u64, b: u64) -> u64 {
    doubles::divide(a, b)
}

/// Compares a with b, as the flags say: the carry is clear where a is less, zero is set where they are equal. Of what
/// is no number neither.
// SAFETY: leaves all registers as they are but for r12 and the flags.
#[unsafe(naked)]
extern "aapcs" fn compared() {
    naked_asm!(
        // No number: larger than infinite. The place of the sign has the bits of the lower word.
        "lsl r12, r1, #1",
        "cmp r0, #0",
        "it ne",
        "orrne r12, r12, #1",
        "cmn r12, #0x200000",
        "it hi",
        "bxhi lr",
        "lsl r12, r3, #1",
        "cmp r2, #0",
        "it ne",
        "orrne r12, r12, #1",
        "cmn r12, #0x200000",
        "it hi",
        "bxhi lr",
        // 0 is -0.
        "orr r12, r0, r2",
        "orr r12, r12, r1, lsl #1",
        "orrs r12, r12, r3, lsl #1",
        "itt eq",
        "cmpeq r12, r12",
        "bxeq lr",
        // Above 0 as whole numbers; where a sign is set the other way round.
        "orrs r12, r1, r3",
        "bmi 1f",
        "cmp r1, r3",
        "it eq",
        "cmpeq r0, r2",
        "bx lr",
        "1:",
        "cmp r3, r1",
        "it eq",
        "cmpeq r2, r0",
        "bx lr",
    )
}

/// A comparison: 1 where the flags of [`compared`] say so, else 0.
macro_rules! comparison {
    ($name:ident, $so:literal, $not:literal) => {
        // SAFETY: the name belongs to this function.
        #[unsafe(no_mangle)]
        #[unsafe(naked)]
        extern "aapcs" fn $name(a: u64, b: u64) -> u32 {
            naked_asm!(
                "push {{r4, lr}}",
                "bl {compared}",
                concat!("ite ", $so),
                concat!("mov", $so, " r0, #1"),
                concat!("mov", $not, " r0, #0"),
                "pop {{r4, pc}}",
                compared = sym compared,
            )
        }
    };
}

comparison!(__aeabi_dcmpeq, "eq", "ne");
comparison!(__aeabi_dcmplt, "lo", "hs");
comparison!(__aeabi_dcmple, "ls", "hi");

/// The same with a and b exchanged.
macro_rules! exchanged {
    ($name:ident as $other:ident) => {
        // SAFETY: the name belongs to this function. Goes on in the other one.
        #[unsafe(no_mangle)]
        #[unsafe(naked)]
        extern "aapcs" fn $name(a: u64, b: u64) -> u32 {
            naked_asm!(
                "mov r12, r0",
                "mov r0, r2",
                "mov r2, r12",
                "mov r12, r1",
                "mov r1, r3",
                "mov r3, r12",
                "b {other}",
                other = sym $other,
            )
        }
    };
}

exchanged!(__aeabi_dcmpgt as __aeabi_dcmplt);
exchanged!(__aeabi_dcmpge as __aeabi_dcmple);

// SAFETY, of all below: the name belongs to this function.

#[unsafe(no_mangle)]
extern "aapcs" fn __aeabi_d2f(a: u64) -> u32 {
    doubles::to_single(a)
}

#[unsafe(no_mangle)]
extern "aapcs" fn __aeabi_f2d(a: u32) -> u64 {
    doubles::from_single(a)
}

#[unsafe(no_mangle)]
extern "aapcs" fn __aeabi_ul2d(count: u64) -> u64 {
    doubles::from_count(0, count)
}

#[unsafe(no_mangle)]
extern "aapcs" fn __aeabi_ui2d(count: u32) -> u64 {
    doubles::from_count(0, count.into())
}

#[unsafe(no_mangle)]
extern "aapcs" fn __aeabi_i2d(number: i32) -> u64 {
    doubles::from_count(number as u32, number.unsigned_abs().into())
}
