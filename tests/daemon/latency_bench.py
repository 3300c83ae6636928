#!/usr/bin/env python3
"""Not a test: from the write of the trigger to the first read that shows the result, beside the
time that detection took, with a client that polls every 2 ms.

    latency_bench.py BINPICKD MODEL [CYCLES]
"""

import re
import sys
import time

import station_process as sp


def main():
    daemon, model = sys.argv[1:3]
    cycles = int(sys.argv[3]) if len(sys.argv) > 3 else 200
    with sp.Station(daemon, model) as station:
        station.start()
        plc = sp.Plc(station)
        waited = {}
        for _ in range(cycles):
            begun = time.monotonic()
            plc.write(sp.DETECT)
            answer = plc.wait(period=0.002)
            waited[answer[20] << 16 | answer[21]] = (time.monotonic() - begun) * 1e3
        plc.close()
        time.sleep(0.5)
        detected = {int(cycle): float(ms) for cycle, ms in
                    re.findall(r"cycle (\d+): detect: .* detect ([0-9.]+) total", station.log())}
    over = sorted(ms - detected[cycle] for cycle, ms in waited.items() if cycle in detected)

    def quantile(share):
        return over[min(len(over) - 1, int(share * len(over)))]

    print(f"{len(over)} cycles, detection {min(detected.values()):.0f} to "
          f"{max(detected.values()):.0f} ms; trigger to result beyond detection: "
          f"median {quantile(0.5):.2f} ms, p90 {quantile(0.9):.2f}, p99 {quantile(0.99):.2f}, "
          f"max {over[-1]:.2f}; at most 5 ms in {sum(v <= 5 for v in over)}")


if __name__ == "__main__":
    main()
