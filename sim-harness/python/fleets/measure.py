"""What a process and all that it starts take: elapsed and processor time, the largest sum of their memory. Linux."""

import os
import subprocess
import tempfile
import time
from pathlib import Path

TICKS = os.sysconf("SC_CLK_TCK")


def measured(command):
    """Runs a command. Out: seconds elapsed, seconds of processor, MB at most. Memory that processes share counts once (Pss)."""
    began, busy, most, ended = time.monotonic(), {}, 0, 0
    with tempfile.TemporaryFile("w+") as said:
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=said)
        while not ended:
            family = descendants(process.pid)
            busy.update((pid, ticks) for pid in family if (ticks := processor_ticks(pid)) is not None)
            most = max(most, sum(map(proportional_kb, family)))
            time.sleep(0.05)
            ended, status, usage = os.wait4(process.pid, os.WNOHANG)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode:
            said.seek(0)
            raise SystemExit(f"{said.read()}\n{' '.join(map(str, command))}: exit code {process.returncode}")
    # A process may end between two looks: the system knows what it took itself.
    processor_s = max(sum(busy.values()) / TICKS, usage.ru_utime + usage.ru_stime)
    return time.monotonic() - began, processor_s, most * 1024 / 1e6


def read(pid, name):
    """Empty where the process has ended."""
    try:
        return Path(f"/proc/{pid}/{name}").read_text()
    except (FileNotFoundError, ProcessLookupError, PermissionError):
        return ""


def fields(pid):
    # After the name, which may have blanks and brackets: the state, the parent, ...
    return read(pid, "stat").rpartition(")")[2].split()


def descendants(root):
    parents = {int(entry.name): fields(entry.name) for entry in Path("/proc").iterdir() if entry.name.isdigit()}
    family, newest = {root}, {root}
    while newest:
        newest = {pid for pid, found in parents.items() if found and int(found[1]) in newest} - family
        family |= newest
    return family


def processor_ticks(pid):
    found = fields(pid)
    return int(found[11]) + int(found[12]) if found else None


def proportional_kb(pid):
    lines = [line for line in read(pid, "smaps_rollup").splitlines() if line.startswith("Pss:")]
    return int(lines[0].split()[1]) if lines else 0
