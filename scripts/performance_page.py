"""Numbers of docs/performance.md from records of measurements; splice-performance.sh calls this.

  performance_page.py measure RECORD.json LOAD PROGRAM COMMAND... [--and COMMAND...]...
                                     runs and records one measurement
  performance_page.py splice FOLDER PAGE.md                         puts the records on the page

Of the table of targets everything but the columns "how" and "what limits it" is written here; those
two are kept as they stand on the page, by the text of the first column.
"""
import json
import math
import os
import re
import resource
import statistics
import subprocess
import sys
import time

SIZES = (10, 20, 30, 50)
SI_10, SI_50 = ("bullet/si", {"iterations": 10}), ("bullet/si", {"iterations": 50})
QUICK_50 = ("ode/quick", {"iterations": 50})
EXACT, FAST = ("ourengine/exact", {}), ("ourengine/fast", {})
FAST_16 = ("ourengine/fast", {"substep_s": 0.000625})
SWEEPS_FLOOR_S = 2.5e-6  # 40 sweeps over the contacts of one brick at the bandwidth of one core


def die(why):
    sys.exit(f"splice-performance: {why}")


def digits(value):
    """Three significant digits; powers of ten where a plain number would be long."""
    if value is None:
        return "-"
    if value == 0:
        return "0"
    if 1e-4 <= abs(value) < 1e6:
        places = 2 - math.floor(math.log10(abs(value)))
        value = round(value, places)
        return f"{value:.{max(places, 0)}f}".rstrip("0").rstrip(".") if places > 0 else f"{value:.0f}"
    return re.sub(r"e([+-])0*", lambda m: "e" + m[1].replace("+", ""), f"{value:.3g}")


# ---- records


def spread(values):
    return {"median": statistics.median(values), "least": min(values), "most": max(values)}


def record_benchmarks(raw, doctor):
    """Google Benchmark's output: per benchmark the spread over the repetitions."""
    seconds = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}
    plain = ("repetition_index", "family_index", "per_family_instance_index", "repetitions", "threads",
             "real_time", "cpu_time")
    runs = {}
    for run in raw["benchmarks"]:
        if run.get("error_occurred"):
            die(f"{run['name']}: {run.get('error_message')}")
        if run["run_type"] == "iteration":
            runs.setdefault(re.sub(r"/(min_time:[^/]*|process_time|real_time)", "", run["name"]), []).append(run)
    benchmarks = []
    for name, repeated in runs.items():
        times = {key: spread([r[key] * seconds[r["time_unit"]] for r in repeated]) for key in ("cpu_time", "real_time")}
        counters = {k: max(r[k] for r in repeated) for k, v in repeated[0].items()
                    if isinstance(v, (int, float)) and k not in plain}
        benchmarks.append({"name": name, "rounds": len(repeated), "cpu_s": times["cpu_time"],
                           "wall_s": times["real_time"], "counters": counters})
    provenance = {"date_utc": raw["context"]["date"], "machine": doctor["machine"]}
    return {"provenance": provenance, "benchmarks": sorted(benchmarks, key=lambda b: b["name"])}


def busy_s():
    """CPU time that all programs of the machine have taken since it started, and the time that a
    virtual machine wanted to run but its host did not let it."""
    with open("/proc/stat", encoding="ascii") as file:
        user, nice, system, _, _, irq, softirq, stolen, *_ = map(int, file.readline().split()[1:])
    tick_s = 1 / os.sysconf("SC_CLK_TCK")
    return (user + nice + system + irq + softirq) * tick_s, stolen * tick_s


def measure(path, load, program, words):
    """`load`: before the start of all measurements. Beside it stands how many cores others kept busy
    meanwhile. The entries of several commands, with "--and" between them, make one record."""
    commands = [[]]
    for word in words:
        if word == "--and":
            commands.append([])
        else:
            commands[-1].append(word)
    start, (busy, stolen), own = time.monotonic(), busy_s(), resource.getrusage(resource.RUSAGE_CHILDREN)
    outputs = []
    for command in commands:
        run = subprocess.run(command, stdout=subprocess.PIPE, check=False)
        if run.returncode not in (0, 1):  # 1: some cell has no result, and says so in its entry
            die(f"{' '.join(command)} failed with {run.returncode}")
        outputs.append(json.loads(run.stdout))
    wall_s, after = time.monotonic() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    busy, stolen = (now - then for now, then in zip(busy_s(), (busy, stolen)))
    if "benchmarks" in outputs[0]:
        kept = record_benchmarks(outputs[0], json.loads(subprocess.check_output([program, "doctor", "--json"])))
    else:
        kept = outputs[0]
        kept["entries"] = [entry for output in outputs for entry in output["entries"]]
        kept["provenance"]["plan"] = os.path.basename(kept["provenance"]["plan"])
    # Folders of whoever ran it are nobody's business.
    named = [" ".join(os.path.basename(word) if word.startswith("/") else word for word in command)
             for command in commands]
    kept["provenance"]["command"] = "; ".join(named)
    kept["provenance"]["load_before"] = float(load)
    own_s = after.ru_utime + after.ru_stime - own.ru_utime - own.ru_stime
    kept["provenance"]["cores_busy_with_others"] = round(max(0.0, busy - own_s) / wall_s, 2)
    kept["provenance"]["cores_withheld_by_host"] = round(stolen / wall_s, 2)
    with open(path + ".new", "w", encoding="utf-8") as file:
        json.dump(kept, file, indent=1)
        file.write("\n")
    os.replace(path + ".new", path)
    print(f"{os.path.basename(path)}: {wall_s:.0f} s; {kept['provenance']['cores_busy_with_others']} cores busy with others")


class Records:
    """What was recorded; a number that was not is None."""

    def __init__(self, folder):
        self.data = {}
        for name in sorted(name for name in os.listdir(folder) if name.endswith(".json")):
            with open(f"{folder}/{name}", encoding="utf-8") as file:
                self.data[name.removesuffix(".json")] = json.load(file)

    def benchmark(self, record_name, name):
        found = [b for b in self.data.get(record_name, {}).get("benchmarks", []) if b["name"] == name]
        if record_name in self.data and not found:
            die(f"{record_name}.json has no benchmark {name}")
        return found[0] if found else None

    def time(self, record_name, name, clock="cpu_s"):
        found = self.benchmark(record_name, name)
        return found and found[clock]["median"]

    def counter(self, record_name, name, counter):
        found = self.benchmark(record_name, name)
        return found and found["counters"][counter]

    def entry(self, record_name, experiment, engine):
        """None as well where the cell did not run to its end, or is flagged: its numbers do not count."""
        if record_name not in self.data:
            return None
        found = [e for e in self.data[record_name]["entries"]
                 if (e["experiment"], e["engine"], e["knobs"]) == (experiment, *engine)]
        if not found:
            die(f"{record_name}.json has no {engine} in {experiment}")
        counts = found[0]["outcome"] == "ok" and not found[0].get("validity")
        return found[0] if counts else None

    def accuracy(self, record_name, experiment, engine, metric):
        found = self.entry(record_name, experiment, engine)
        return found and found["accuracy"][metric]

    def cost(self, record_name, experiment, engine):
        """CPU s per simulated s."""
        found = self.entry(record_name, experiment, engine)
        return found and found["cpu_per_simulated_s"]["median"]


# ---- targets


class Group:
    """Values of one kind beside each other: `must` and `aim` are one bound for all, or one each.
    A bound is the most that is allowed, or a range (least, most)."""

    def __init__(self, name, values, must, aim=None, unit="", scale=1.0, labels=None):
        self.name, self.unit, self.scale = name, unit, scale
        self.values = values
        self.labels = labels or [f"{n}x{n}" for n in SIZES[:len(values)]]
        self.must, self.aim = must, aim

    def bound(self, bound):
        def text(one):
            return f"{digits(one[0])} to {digits(one[1])}" if isinstance(one, tuple) else digits(one)
        if bound is None:
            return ""
        listed = bound if isinstance(bound, list) else [bound]
        return (" / ".join(text(one) for one in listed) + " " + self.unit).strip()

    def measured(self):
        values = [v if v is None else v * self.scale for v in self.values]
        return f"{self.name} {' / '.join(map(digits, values))} {self.unit}".strip()

    def misses(self):
        found = []
        for i, value in enumerate(self.values):
            must = self.must[i] if isinstance(self.must, list) else self.must
            where = " ".join(part for part in (self.name, self.labels[i]) if part)
            if must is None:
                continue
            if value is None:
                found.append(f"{where} did not run")
            elif isinstance(must, tuple):
                if not must[0] <= value * self.scale <= must[1]:
                    found.append(where)
            elif value * self.scale > must:
                found.append(f"{where} by {digits(value * self.scale / must)} times")
        return found


def over(a, b):
    return None if a is None or b is None else a / b


def worst(values):
    return None if None in values else max(values)


def targets(r):
    """(text of the first column, record, groups) of every target."""
    def cold(kind, size, seed=1):
        return r.time("contact", f"{kind}/{size}x{size}/seed{seed}")

    frictionless = [f"frictionless/{state}/{n}x{n}/seed1" for state in ("rest", "impact") for n in SIZES]
    at_rest = [f"friction_at_rest/{n}x{n}" for n in (10, 30)]
    slips = {d: [f"slipping_impact/10x10/to{d}digits/seed{s}" for s in range(1, 6)] for d in (3, 6)}
    three = SIZES[:3]

    def residual(names, must):
        return Group("residual", [worst([r.counter("contact", n, "residual") for n in names])], must, labels=[""])

    def slip(digits_, must, aim):
        times = [r.time("contact", n) for n in slips[digits_]]
        least = None if None in times else min(times)
        return Group(f"to 1e-{digits_} in", [least, worst(times)], must, aim, "ms", 1e3,
                     ["least of five seeds", "most of five seeds"])

    def accuracy(record_name, experiment, engine, metric, sizes=SIZES):
        return [r.accuracy(record_name, f"{experiment}_{n}", engine, metric) for n in sizes]

    def ratio(experiment, engine, base, sizes=SIZES):
        return [over(r.cost("performance", f"{experiment}_{n}", engine),
                     r.cost("performance", f"{experiment}_{n}", base)) for n in sizes]

    def step(n, threads, clock):
        return r.time("engine", f"fast_step/n:{n}/threads:{threads}", clock)

    def kapla(engine):
        return [Group("drift", [r.accuracy("kapla", "sixty_thousand_steps", engine, "brick_displacement_max_m")],
                      *((1e-6, 1e-9, "m") if engine is EXACT else (1, 0.1, "mm", 1e3)), labels=[""]),
                Group("time", [over(r.cost("kapla", "sixty_thousand_steps", engine), 1 / 600)],
                      *((60, 15) if engine is EXACT else (16, 8)), "s", labels=[""])]

    def separation(kind):
        return [over(r.time("engine", f"separate_{kind}/tilt_crad:{tilt}"),
                     r.counter("engine", f"separate_{kind}/tilt_crad:{tilt}", "pairs")) for tilt in (1, 300)]

    tilts = ["near the grid", "in any attitude"]
    metric = {"overlap": "penetration_max_m", "end": "penetration_final_m", "rms": "brick_speed_rms_mps",
              "drift": "brick_displacement_max_m"}
    ten = "standing_walls"
    return [
        ("frictionless problem, 10x10 / 20x20 / 30x30 / 50x50", "contact", [
            Group("at rest", [cold("frictionless/rest", n) for n in SIZES],
                  [3.5, 30, 100, 600], [1.5, 15, 60, 350], "ms", 1e3),
            Group("impact", [cold("frictionless/impact", n) for n in SIZES],
                  [3.5, 30, 100, 600], [1.5, 15, 60, 350], "ms", 1e3),
            residual(frictionless, 1e-10)]),
        ("friction at rest, 10x10 / 30x30", "contact", [
            Group("", [r.time("contact", n) for n in at_rest], [7, 115], [3, 60], "ms", 1e3, ["10x10", "30x30"]),
            residual(at_rest, 1e-10)]),
        ("slipping impact, 10x10, over five seeds", "contact", [
            slip(3, 50, None), slip(6, None, 200), residual(slips[3], 1e-3)]),
        ("standing wall, 10 s, `exact`, 10x10 / 20x20 / 30x30", ten, [
            Group("overlap", accuracy(ten, "standing", EXACT, metric["overlap"], three), 1e-8, 1e-12, "m"),
            Group("rms speed", accuracy(ten, "standing", EXACT, metric["rms"], three), 1e-6, 1e-9, "m/s"),
            Group("drift", accuracy(ten, "standing", EXACT, metric["drift"], three), 1e-6, 1e-9, "m")]),
        ("its time over 50 iterations of others, 10x10 / 20x20 / 30x30", "performance", [
            Group("sequential impulses", ratio("standing", EXACT, SI_50, three), 1, 0.5),
            Group("quick-step", ratio("standing", EXACT, QUICK_50, three), 1, 0.5)]),
        ("`fast`, hit walls, 10x10 / 20x20 / 30x30 / 50x50: time over 10 iterations of sequential impulses",
         "performance", [Group("", ratio("hit", FAST, SI_10), 0.3, 0.1)]),
        ("`fast`, hit walls, 10x10 / 20x20 / 30x30 / 50x50: bricks moved", "performance", [
            Group("", accuracy("performance", "hit", FAST, "bricks_displaced"), (5, 9))]),
        ("`fast`, standing 10 s, 10x10 / 20x20 / 30x30 / 50x50", ten, [
            Group("drift", accuracy(ten, "standing", FAST, metric["drift"]), 1, 0.1, "mm", 1e3),
            Group("overlap at the end", accuracy(ten, "standing", FAST, metric["end"]), 0.5, 0.05, "mm", 1e3),
            Group("rms speed", accuracy(ten, "standing", FAST, metric["rms"]), 1, 0.01, "mm/s", 1e3)]),
        ("`fast`, 10 000 bricks standing, per brick and step over the floor", "engine", [
            Group("two threads, wall time", [over(step(100, 2, "wall_s"), 1e4 * SWEEPS_FLOOR_S)], 5, 2, labels=[""]),
            Group("one thread, CPU time", [over(step(100, 1, "cpu_s"), 1e4 * SWEEPS_FLOOR_S)], None, labels=[""])]),
        ("`fast`, wall time of two threads over one, 10x10 / 30x30 / 50x50 / 100x100", "engine", [
            Group("", [over(step(n, 2, "wall_s"), step(n, 1, "wall_s")) for n in (10, 30, 50, 100)],
                  [None, None, 1, 1], labels=["10x10", "30x30", "50x50", "100x100"])]),
        ("Kapla tower, 60 000 steps, `exact`", "kapla", kapla(EXACT)),
        ("Kapla tower, 60 000 steps, `fast` with 16 sub-steps", "kapla", kapla(FAST_16)),
        ("torque-free box, 1/240 s", "engine", [
            Group("energy over 100 s", [r.counter("engine", "torque_free", "energy_error")], 1e-7, 1e-12, labels=[""]),
            Group("attitude after 10 s", [r.counter("engine", "torque_free", "attitude_error_rad")],
                  None, 1e-6, "rad", labels=[""])]),
        ("separating axes, nearly touching pairs, near the grid / in any attitude", "engine", [
            Group("", separation("batch"), 25, 12, "ns", 1e9, tilts),
            Group("scalar twin", separation("scalar"), None, None, "ns", 1e9, tilts)]),
        ("a brick of 20 m/s, 1/240 s: deepest overlap, 10x10 / 20x20 / 30x30 / 50x50", "performance", [
            Group("`exact`, first only", [r.accuracy("performance", "impact_10", EXACT, metric["overlap"])], 1,
                  unit="mm", scale=1e3),
            Group("`fast`", accuracy("performance", "hit", FAST, metric["overlap"]), 1,
                  unit="mm", scale=1e3),
            Group("sequential impulses with 10 iterations", accuracy("performance", "hit", SI_10, metric["overlap"]),
                  None, unit="mm", scale=1e3)]),
    ]


def bounds(groups, which):
    """The bounds of a row; one that several groups share is named for none of them."""
    found = {}
    for group in groups:
        text = group.bound(getattr(group, which))
        if text:
            found[text] = "" if text in found else group.name
    return "; ".join(f"{name} {text}".strip() for text, name in found.items())


def table_of_targets(r, page):
    old = {}
    for line in page.split("<!-- BEGIN targets -->")[1].split("<!-- END targets -->")[0].splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if len(cells) == 6:
            old[cells[0]] = cells[4:]
    lines = ["| what | must | aim | measured | how | what limits it |", "|---|---|---|---|---|---|"]
    for what, record_name, groups in targets(r):
        if what not in old:
            die(f"the table of targets has no row '{what}' to take 'how' and 'what limits it' from")
        if record_name in r.data:
            measured = "; ".join(group.measured() for group in groups)
            misses = [miss for group in groups for miss in group.misses()]
            if misses:
                measured += ". **missed**: " + ", ".join(misses)
        else:
            measured = "not recorded"
        lines.append(f"| {what} | {bounds(groups, 'must')} | {bounds(groups, 'aim')} | {measured} | "
                     f"{' | '.join(old.pop(what))} |")
    left = [what for what in old if what != "what" and set(what) != {"-"}]
    if left:
        die(f"nothing is measured for the rows {left} of the table of targets")
    lines.append("")
    for name, data in r.data.items():
        lines.append(f"- `{name}.json`: {origin(data['provenance'])}")
    return "\n".join(lines)


def origin(provenance):
    machine = provenance["machine"]
    load = provenance.get("load_before")
    before = "" if load is None else (f", load {load:g} before the start, "
                                      f"{provenance['cores_busy_with_others']:g} cores busy with others meanwhile")
    if provenance.get("cores_withheld_by_host"):
        before += f", {provenance['cores_withheld_by_host']:g} cores withheld by the host"
    return (f"{machine['cpu']}, {machine['cores']} cores{before}, revision {machine['revision']}, "
            f"{provenance['date_utc']}.")


def table_of_bench(data):
    lines = [f"| experiment | engine | ms per step | over {data['base']} | moved furthest, m | deepest overlap, m | "
             "overlap at the end, m | rms speed at the end, m/s | bricks moved | rounds | outcome |",
             "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---|"]
    for e in data["entries"]:
        knobs = ", ".join(f"{k} {digits(v)}" for k, v in e["knobs"].items())
        engine = f"`{e['engine']}`" + (f" ({knobs})" if knobs else "") + (", base" if e["is_base"] else "")
        ratio = e["ratio_to_base"]
        accuracy = [digits(e["accuracy"].get(k)) for k in (
            "brick_displacement_max_m", "penetration_max_m", "penetration_final_m", "brick_speed_rms_mps",
            "bricks_displaced")]
        lines.append("| " + " | ".join([
            e["experiment"], engine, digits(e["step_cpu_s"] and 1e3 * e["step_cpu_s"]["median"]),
            f"{digits(ratio['median'])} ({digits(ratio['least'])}..{digits(ratio['most'])})" if ratio else "-",
            *accuracy, str(e["rounds"]), e["outcome"] + (f"; ! {e['validity']}" if e.get("validity") else "")
            + ("" if e["repeatable"] else ", not repeatable")]) + " |")
    lines += ["", "Medians over the rounds, CPU time of the stepping thread; (least..most) of the ratios. "
              + origin(data["provenance"])]
    return "\n".join(lines)


def put(page, name, text):
    begin, end = f"<!-- BEGIN {name} -->\n", f"<!-- END {name} -->"
    if page.count(begin) != 1 or page.count(end) != 1:
        die(f"the page must have one line '{begin.strip()}' and one '{end}'")
    head, rest = page.split(begin)
    return f"{head}{begin}\n{text}\n\n{end}{rest.split(end)[1]}"


def splice(folder, path):
    r = Records(folder)
    with open(path, encoding="utf-8") as file:
        page = file.read()
    page = put(page, "targets", table_of_targets(r, page))
    for name, data in r.data.items():
        if "entries" in data:
            page = put(page, name, table_of_bench(data))
    with open(path, "w", encoding="utf-8") as file:
        file.write(page)
    print(f"splice-performance: {path} has the numbers of {', '.join(r.data)}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["measure"] and len(sys.argv) > 5:
        measure(*sys.argv[2:5], sys.argv[5:])
    elif sys.argv[1:2] == ["splice"] and len(sys.argv) == 4:
        splice(*sys.argv[2:])
    else:
        sys.exit(__doc__)
