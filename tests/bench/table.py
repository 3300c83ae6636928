"""Turns the JSON that `run` writes into tables in Markdown."""

ISAS = ("scalar", "sse4", "avx2", "avx512")


def percentile(values, share):
    """Interpolates linearly between order statistics."""
    values = sorted(values)
    at = share * (len(values) - 1)
    low = int(at)
    return values[low] + (at - low) * (values[min(low + 1, len(values) - 1)] - values[low])


def median(values):
    return percentile(values, 0.5)


def rows_of(head, rows):
    lines = [head, ["---"] * len(head), *rows]
    return ["| " + " | ".join(str(cell) for cell in line) + " |" for line in lines] + [""]


def machine_lines(machine):
    return [f"{machine['cpu']}, {machine['cores']} cores, {machine['isa']}; commit "
            f"{machine['commit']}, {machine['date']}; load average {machine['load_before']} before "
            f"and {machine['load_after']} after.", ""]


def read_limits(kernels):
    """GB/s and capacity of each level of memory, the smallest first."""
    limits = [(k["capacity"], name.removeprefix("read/"), k["bytes"] / k["ns"])
              for name, k in kernels.items() if name.startswith("read/")]
    return sorted(limits)


def kernel_lines(kernels):
    limits = read_limits(kernels)
    gigahertz = 400 / kernels["400_cycles"]["ns"]
    vector = next(k["vector_bytes"] for name, k in kernels.items() if name.startswith("read/"))
    reads = [[level, f"{speed:.1f}", f"{speed / vector / gigahertz:.2f}"]
             for _, level, speed in limits]
    isas = [isa for isa in ISAS if f"scan_cells/{isa}" in kernels]
    rows = []
    for name in [n.removesuffix("/scalar") for n in kernels if n.endswith("/scalar")]:
        of = {isa: kernels[f"{name}/{isa}"] for isa in isas}
        row = [name, f"{of['scalar']['ns']:.0f}"]
        row += [f"{k['ns']:.0f} ({of['scalar']['ns'] / k['ns']:.1f})" for k in of.values()][1:]
        best = of[isas[-1]]
        if best["bytes"] > 0:
            _, level, limit = next(one for one in limits if one[0] >= best["set_bytes"])
            speed = best["bytes"] / best["ns"]
            row += [f"{speed:.1f}", level, f"{100 * speed / limit:.0f} %"]
        rows.append(row + [""] * (len(isas) + 4 - len(row)))
    return ["## Kernels", "",
            f"What the machine can do: reads of {vector:.0f} bytes, at {gigahertz:.2f} GHz.", "",
            *rows_of(["memory", "GB/s", "reads a cycle"], reads),
            "ns a call, median; in brackets how many times faster than scalar. What memory may "
            f"bound ({isas[-1]}): the bytes that a call has to move, against reads from the level "
            "that holds its images.", "",
            *rows_of(["kernel", *isas, "GB/s", "data in", "of its reads"], rows)]


def column(samples, key, index=None):
    return [s[key] if index is None else s[key][index] for s in samples]


def stage_lines(system):
    settings = system["stages"]
    head = ["step"] + [f"{name}: {what}" for name in settings for what in ("p50", "p99", "max")]
    keys = [("stages", i, name) for i, name in enumerate(system["stage_names"])]
    rows = []
    for key, index, name in keys + [("total", None, "**all**")]:
        times = [column(samples, key, index) for samples in settings.values()]
        rows.append([name] + [f"{value:.1f}" for t in times
                              for value in (median(t), percentile(t, 0.99), max(t))])
    one, two = (column(samples, "total") for samples in settings.values())
    ratio = median([a / b for a, b in zip(one, two)])
    return ["## Steps of a detection, ms", "", *rows_of(head, rows),
            f"{len(one)} searches each. Two threads are {ratio:.2f} times as fast as one.", ""]


def layout_lines(system):
    """Both layouts searched the same frames in the same order."""
    pairs = list(zip(system["layout"]["rearranged"], system["layout"]["plain"]))
    stages = system["stage_names"]
    rows = []

    def add(name, value, chosen):
        if chosen:
            fast, slow = [value(a) for a, _ in chosen], [value(b) for _, b in chosen]
            ratio = median([b / a for a, b in zip(fast, slow)])
            rows.append([name, f"{median(fast):.1f}", f"{median(slow):.1f}", f"{ratio:.2f}"])

    for depth in range(len(pairs[0][0]["levels"])):
        below = [p for p in pairs if p[0]["scan_depth"] < depth and p[0]["levels"][depth] > 0]
        add(f"matching at depth {depth}", lambda s, d=depth: s["levels"][d], below)
    add("descend", lambda s: s["stages"][stages.index("descend")], pairs)
    add("pyramid, scan and descend", lambda s: sum(s["stages"][:3]), pairs)
    add("all", lambda s: s["total"], pairs)
    return ["## Rearranged against plain maps, ms on one thread", "",
            *rows_of(["", "rearranged", "plain", "ratio"], rows)]


def sweep_lines(system):
    lines = ["## Cost against the size of the task, ms on two threads", ""]
    heads = {"region": "region", "resolution": "megapixels", "models": "models",
             "instances": "parts in the bin"}
    for experiment, head in heads.items():
        settings = system[experiment].items()
        if experiment in ("resolution", "instances"):
            settings = sorted((float(name), samples) for name, samples in settings)
            settings = [(f"{number:.2g}", samples) for number, samples in settings]
        first = None
        rows = []
        for name, samples in settings:
            total = median(column(samples, "total"))
            first = first or total
            stages = [median(column(samples, "stages", i)) for i in range(len(
                system["stage_names"]))]
            rows.append([name, f"{total:.1f}", f"{total / first:.2f}",
                         *(f"{ms:.1f}" for ms in stages)])
        lines += rows_of([head, "p50", "ratio", *system["stage_names"]], rows)
    return lines


def peer_lines(results):
    system, scores = results["system"], results["scores"]
    one = column(system["stages"]["1 thread"], "total")
    times = {"binpick": (sum(one) / len(one), None)}
    for peer, ms in results.get("peers", {}).items():
        mean = {key: sum(values) / len(values) for key, values in ms.items()}
        times[peer] = (mean["total_ms"], mean["match_ms"])
    rows = []
    for name, (total, match) in times.items():
        score = scores[name]
        rows.append([name, f"{total:.0f}", "" if match is None else f"{match:.0f}",
                     f"{total / times['binpick'][0]:.0f}",
                     *(f"{score[figure]:.3f}" for figure in ("f1", "precision", "recall"))])
    return ["## Beside OpenCV, on the same frames, one thread", "",
            *rows_of(["", "ms a frame", "until matched", "times binpick", "F1", "precision",
                      "recall"], rows),
            "Means over frames and parts, at the best threshold of each part. OpenCV's searches "
            "run close to their defaults; ICP (also OpenCV's) and the check against the depth "
            "image were added, since neither brings them, and were not tuned.", ""]


def markdown(results):
    lines = ["# Benchmarks", "", *machine_lines(results["machine"]),
             *kernel_lines(results["kernels"]), *stage_lines(results["system"]),
             *layout_lines(results["system"]), *sweep_lines(results["system"]),
             *peer_lines(results)]
    return "\n".join(lines).rstrip() + "\n"
