"""What palpate-view with a connected page costs the daemon's loop.

usage: loop_cost.py BINARIES SOURCE [--seconds S] [--turns N] [--priority P]

Runs simulator and daemon, by turns without palpate-view, with it and a reader that takes all
pictures but draws none (a browser on another machine), and with it and a browser that draws in
software on this machine's processors. Prints the loop's cycle time and wake-up as HEALTH reports
them, and the processor's share of each program.
"""
import argparse
import struct
import sys
import time

from cell import Cell, wait_for
from page_reader import PageReader
import udpm

PHASES = {0: "cycle", 8: "publish", 9: "wake-up"}


def health(data):
    """50 and 99 % of each phase, us."""
    at = struct.calcsize(udpm.COMMON) + 4 + 6 * 8
    (phases,) = struct.unpack_from(">i", data, at)
    assert phases == 10
    return struct.unpack_from(">10f10f", data, at + 4)


def processor_time(process):
    with open(f"/proc/{process.pid}/stat") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / 100  # s


def turn(options, who):
    cell = Cell(options.binaries, options.source)
    listener = udpm.Listener(cell.group, cell.ports[1])
    reader = None
    try:
        cell.start_simulator()
        cell.start_daemon(options.priority)
        cell.start_view()
        cell.open_browser(1280, 800)
        wait_for(lambda: cell.js("!!window.palpate && palpate.control.granted"), "the page")
        cell.click('#commands [data-event="start"]')
        wait_for(lambda: cell.text("#state") in ("active", "degraded"), "the start")
        if who != "browser":
            cell.browser.quit()
            cell.browser = None
        if who == "none":
            cell.stop("palpate-view")
        if who == "reader":
            reader = PageReader(cell.port)
        before = {name: processor_time(p) for name, p in cell.processes.items()}
        bytes_before, pictures_before = (reader.bytes, reader.pictures) if reader else (0, 0)
        time.sleep(options.seconds)
        used = {name: processor_time(p) - before[name] for name, p in cell.processes.items()}
        values = health(listener.last["HEALTH"])
        times = "; ".join(f"{name} {values[i]:.0f} / {values[10 + i]:.0f} us" for i, name in PHASES.items())
        shares = ", ".join(f"{name} {100 * s / options.seconds:.1f} %" for name, s in used.items())
        rate = "" if not reader else (
            f"; {(reader.pictures - pictures_before) / options.seconds:.1f} pictures/s, "
            f"{(reader.bytes - bytes_before) / options.seconds / 1e3:.0f} kB/s")
        print(f"{who}: {times} (50 / 99 %); processor: {shares}{rate}", flush=True)
    finally:
        if reader:
            reader.close()
        listener.stop()
        cell.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("binaries")
    parser.add_argument("source")
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--priority", type=int, default=50, help="of the loop, SCHED_FIFO; 0: none")
    options = parser.parse_args()
    for _ in range(options.turns):
        for who in ("none", "reader", "browser"):
            turn(options, who)
    return 0


if __name__ == "__main__":
    sys.exit(main())
