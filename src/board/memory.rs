//! The functions that the compiler calls to copy and to fill memory. The linker takes these before the compiler's,
//! which are ten times as large.
//!
//! Names and calls are those of Arm's run-time ABI (RTABI, 4.3.4): nothing is returned, and a fill has its length
//! before its byte. The core reads and writes a word at any address, several at once only at multiples of four.

use core::arch::naked_asm;

/// From the first byte on.
// SAFETY: the name belongs to this function. It writes r0 to r3 and r12, which are its own, and r4 and r5, which it
// gives back.
#[unsafe(no_mangle)]
#[unsafe(naked)]
extern "aapcs" fn __aeabi_memcpy(to: *mut u8, from: *const u8, length: usize) {
    naked_asm!(
        "push {{r4, r5, lr}}",
        "orr r3, r0, r1",
        "lsls r3, r3, #30",
        "bne 2f",
        "1:",
        "subs r2, r2, #16",
        "ittt hs",
        "ldmhs r1!, {{r3, r4, r5, r12}}",
        "stmhs r0!, {{r3, r4, r5, r12}}",
        "bhs 1b",
        "add r2, r2, #16",
        "2:",
        "subs r2, r2, #4",
        "ittt hs",
        "ldrhs r3, [r1], #4",
        "strhs r3, [r0], #4",
        "bhs 2b",
        "add r2, r2, #4",
        "3:",
        "subs r2, r2, #1",
        "ittt hs",
        "ldrbhs r3, [r1], #1",
        "strbhs r3, [r0], #1",
        "bhs 3b",
        "pop {{r4, r5, pc}}",
    )
}

/// As if the bytes were somewhere else in between: from the last one on where they go up.
// SAFETY: as above, but for r4 and r5.
#[unsafe(no_mangle)]
#[unsafe(naked)]
extern "aapcs" fn __aeabi_memmove(to: *mut u8, from: *const u8, length: usize) {
    naked_asm!(
        "cmp r0, r1",
        "bls {copy}",
        "add r0, r0, r2",
        "add r1, r1, r2",
        "1:",
        "subs r2, r2, #4",
        "ittt hs",
        "ldrhs r3, [r1, #-4]!",
        "strhs r3, [r0, #-4]!",
        "bhs 1b",
        "add r2, r2, #4",
        "2:",
        "subs r2, r2, #1",
        "ittt hs",
        "ldrbhs r3, [r1, #-1]!",
        "strbhs r3, [r0, #-1]!",
        "bhs 2b",
        "bx lr",
        copy = sym __aeabi_memcpy,
    )
}

/// With one byte.
// SAFETY: as above.
#[unsafe(no_mangle)]
#[unsafe(naked)]
extern "aapcs" fn __aeabi_memset(to: *mut u8, length: usize, byte: u32) {
    naked_asm!(
        "uxtb r2, r2",
        "orr r2, r2, r2, lsl #8",
        "orr r2, r2, r2, lsl #16",
        "mov r3, r2",
        "lsls r12, r0, #30",
        "bne 2f",
        "1:",
        "subs r1, r1, #8",
        "itt hs",
        "stmhs r0!, {{r2, r3}}",
        "bhs 1b",
        "add r1, r1, #8",
        "2:",
        "subs r1, r1, #4",
        "itt hs",
        "strhs r2, [r0], #4",
        "bhs 2b",
        "add r1, r1, #4",
        "3:",
        "subs r1, r1, #1",
        "itt hs",
        "strbhs r2, [r0], #1",
        "bhs 3b",
        "bx lr",
    )
}

/// With zeros.
// SAFETY: the name belongs to this function.
#[unsafe(no_mangle)]
#[unsafe(naked)]
extern "aapcs" fn __aeabi_memclr(to: *mut u8, length: usize) {
    naked_asm!("movs r2, #0", "b {set}", set = sym __aeabi_memset)
}

/// Names for addresses at multiples of four and eight.
macro_rules! aligned {
    ($($four:ident, $eight:ident are $any:ident($($argument:ident: $Type:ty),*);)*) => {$(
        // SAFETY: the names belong to these functions, which go on with their arguments where they have been.
        #[unsafe(no_mangle)]
        #[unsafe(naked)]
        extern "aapcs" fn $four($($argument: $Type),*) {
            naked_asm!("b {any}", any = sym $any)
        }

        // SAFETY: the same.
        #[unsafe(no_mangle)]
        #[unsafe(naked)]
        extern "aapcs" fn $eight($($argument: $Type),*) {
            naked_asm!("b {any}", any = sym $any)
        }
    )*};
}

aligned! {
    __aeabi_memcpy4, __aeabi_memcpy8 are __aeabi_memcpy(to: *mut u8, from: *const u8, length: usize);
    __aeabi_memmove4, __aeabi_memmove8 are __aeabi_memmove(to: *mut u8, from: *const u8, length: usize);
    __aeabi_memset4, __aeabi_memset8 are __aeabi_memset(to: *mut u8, length: usize, byte: u32);
    __aeabi_memclr4, __aeabi_memclr8 are __aeabi_memclr(to: *mut u8, length: usize);
}
