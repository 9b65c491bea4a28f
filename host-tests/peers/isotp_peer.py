"""Host side of the CAN link, by python-can and can-isotp: talks to the device that tests/peers.rs plays.

Arguments: TCP port, classic or fd, block size, separation time in ms. Each message goes to the device, which sends back
its bytes inverted. CRC-32C is computed here bit by bit. Exit code 0 and a line "ok" when all came back right.
"""

import random
import sys
import time

import can
import isotp

TO_BOARD, FROM_BOARD = 0x6D0, 0x6D1
# Both sides of the borders of single frames, with four bytes of checksum each, and what was asked for.
SIZES = [1, 2, 3, 4, 7, 8, 20, 58, 59, 100, 500, 512]


def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc >> 1) ^ (0x82F63B78 if crc & 1 else 0)
    return crc ^ 0xFFFFFFFF


def checked(message):
    return message + crc32c(message).to_bytes(4, "little")


def exchange(stack, payload, wait_s, failed=lambda: False):
    """Sends a payload and gives the next one that arrives within the time, or None; also None when it failed."""
    stack.send(payload)
    end = time.monotonic() + wait_s
    while time.monotonic() < end and not failed():
        stack.process()
        if stack.available():
            return bytes(stack.recv())
        time.sleep(0.0005)
    return None


def main():
    port, kind, block_size, separation_ms = sys.argv[1:]
    fd = kind == "fd"
    errors = []
    bus = can.Bus(interface="slcan", channel=f"socket://127.0.0.1:{port}", sleep_after_open=0)
    stack = isotp.CanStack(
        bus,
        address=isotp.Address(isotp.AddressingMode.Normal_11bits, txid=TO_BOARD, rxid=FROM_BOARD),
        error_handler=errors.append,
        params={
            "blocksize": int(block_size),
            "stmin": int(separation_ms),
            "can_fd": fd,
            "tx_data_length": 64 if fd else 8,
            "bitrate_switch": fd,
        },
    )
    rng = random.Random(1)
    for size in SIZES:
        message = rng.randbytes(size)
        answer = exchange(stack, checked(message), 20)
        assert answer is not None, f"{size} bytes: no answer, errors {errors}"
        expected = checked(bytes(byte ^ 0xFF for byte in message))
        assert answer == expected, f"{size} bytes: {answer.hex()} instead of {expected.hex()}"
    assert not errors, errors

    # A wrong checksum is not answered.
    damaged = bytearray(checked(b"damaged on the way"))
    damaged[3] ^= 1
    assert exchange(stack, bytes(damaged), 0.5) is None, "a wrong checksum was answered"
    assert not errors, errors

    # A payload without room is refused by flow control, and the link goes on.
    assert exchange(stack, bytes(600), 20, failed=lambda: errors) is None, "600 bytes were answered"
    assert [type(error) for error in errors] == [isotp.OverflowError], errors
    assert exchange(stack, checked(b"x"), 20) == checked(bytes([ord("x") ^ 0xFF])), "no answer after an overflow"
    bus.shutdown()
    print("ok")


main()
