#!/usr/bin/env python3
"""The tables that benchmarks are reported in, made of a small result."""

import sys
import unittest

sys.dont_write_bytecode = True
import table  # noqa: E402


def kernel(ns, moved=0, in_set=0):
    return {"ns": ns, "bytes": moved, "set_bytes": in_set}


def search(total, matching, scan_depth=1):
    return {"total": total, "stages": [1, 2, total - 3], "levels": [0, 9, matching],
            "scan_depth": scan_depth}


RESULTS = {
    "machine": {"cpu": "a CPU", "cores": 2, "isa": "avx2", "commit": "abc", "date": "2026-01-02",
                "load_before": 0.1, "load_after": 0.9},
    "kernels": {"read/L1": kernel(1, 64) | {"capacity": 1000, "vector_bytes": 32},
                "read/memory": kernel(10, 64) | {"capacity": 1e18, "vector_bytes": 32},
                "400_cycles": kernel(200),
                "scan_cells/scalar": kernel(80, 400, 900), "scan_cells/avx2": kernel(10, 400, 900),
                "match_edges/scalar": kernel(90), "match_edges/avx2": kernel(45)},
    "system": {"stage_names": ["pyramid", "scan", "descend"],
               "stages": {"1 thread": [search(20, 4), search(30, 4), search(40, 4)],
                          "2 threads": [search(10, 4), search(15, 4), search(20, 4)]},
               "layout": {"rearranged": [search(10, 2), search(12, 0, 2)],
                          "plain": [search(20, 6), search(24, 0, 2)]},
               "region": {"small": [search(10, 1)], "large": [search(25, 1)]},
               "resolution": {"1.31": [search(20, 1)], "0.33": [search(16, 1)]},
               "models": {"1": [search(20, 1)]}, "instances": {"5": [search(20, 1)]}},
    "scores": {"binpick": {"f1": 0.9, "precision": 0.8, "recall": 0.7},
               "ppf": {"f1": 0.5, "precision": 0.4, "recall": 0.3}},
    "peers": {"ppf": {"match_ms": [200, 400], "total_ms": [500, 700]}},
}


class TableTest(unittest.TestCase):
    def test_each_figure_has_its_row(self):
        lines = table.markdown(RESULTS).splitlines()
        for row in ("| L1 | 64.0 | 1.00 |",
                    "| scan_cells | 80 | 10 (8.0) | 40.0 | L1 | 62 % |",
                    "| match_edges | 90 | 45 (2.0) |  |  |  |",
                    "| **all** | 30.0 | 39.8 | 40.0 | 15.0 | 19.9 | 20.0 |",
                    "3 searches each. Two threads are 2.00 times as fast as one.",
                    "| matching at depth 2 | 2.0 | 6.0 | 3.00 |",
                    "| large | 25.0 | 2.50 | 1.0 | 2.0 | 22.0 |",
                    "| ppf | 600 | 300 | 20 | 0.500 | 0.400 | 0.300 |"):
            self.assertIn(row, lines)

    def test_numbers_are_in_order(self):
        text = table.markdown(RESULTS)
        self.assertLess(text.index("| 0.33 | 16.0 | 1.00 |"), text.index("| 1.3 | 20.0 | 1.25 |"))


if __name__ == "__main__":
    unittest.main()
