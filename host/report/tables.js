// Tables and lists of facts.

function regionName(scene, region) {
    return region === 0 ? "whole image" : scene.regions[region].name;
}

// A run's name behind a piece of its line.
function runName(view, run) {
    const style = view.styles[run];
    const key = element("span", {
        class: style >= RUN_COLOURS ? "key dashed" : "key",
        style: `--colour: var(${styleColour(style)})`,
        "aria-hidden": "true",
    });
    return element("span", { class: "run" }, key, view.labels[run]);
}

function muted(text) {
    return element("span", { class: "muted" }, text);
}

// Per error, when each run stays at or below it, and how many times as long as the fastest that takes.
function timesTable(view, group, region) {
    const summary = view.summary(group)[region];
    const headers = ["RMSE", ...group.runs.map((run) => view.labels[run])];
    const rows = summary.levels.map((level, i) => {
        const times = summary.times[i];
        const fastest = Math.min(...times.filter((time) => time !== null));
        const cells = times.map((time) => {
            if (time === null) return muted(NONE);
            if (time === fastest) return element("strong", {}, formatSeconds(time));
            return element("span", {}, formatSeconds(time), " ", muted(formatRatio(time / fastest)));
        });
        return [formatRound(level), ...cells];
    });
    if (rows.length === 0) return null;
    const made = table("Time to reach an RMSE, with the ratio to the fastest", headers, rows);
    made.querySelectorAll("thead th").forEach((cell, i) => {
        if (i > 0) cell.replaceChildren(runName(view, group.runs[i - 1]));
    });
    return made;
}

function errorBar(error, greatest) {
    const part = error > 0 ? (100 * error) / greatest : 0;
    return element("span", { class: "bar", style: `--part: ${part}%`, "aria-hidden": "true" });
}

// Beyond this factor of time a curve is flat for all one can tell.
const MOST_TO_HALVE = 1000;

// What each run came to at equal time.
function runsTable(view, group, region) {
    const results = view.results(group, region);
    const baseline = results.find((result) => result.run === group.baseline);
    const greatest = Math.max(...results.map((result) => result.error ?? 0));
    const time = view.summary(group)[region].equal_time;
    const ahead = results.some((result) => result.aheadFrom !== null);
    const headers = ["Run", "RMSE", "Spread", "RMSE / baseline’s", "Slope", "Time to halve the error"];
    if (ahead) headers.push("Best is ahead from");
    headers.push("Passes", "Photons");
    const rows = results.map((result) => {
        const { run, curve } = result;
        const measured = view.scene.runs[run];
        const ratio = formatRatio((result.error ?? NaN) / (baseline?.error ?? NaN));
        const error = element(result.best ? "strong" : "span", {}, formatNumber(result.error));
        const cells = [
            runName(view, run),
            element("span", {}, error, errorBar(result.error, greatest)),
            result.low === result.high ? NONE : `${formatNumber(result.low)} – ${formatNumber(result.high)}`,
            run === group.baseline ? "baseline" : ratio,
            formatNumber(curve.slope, 2),
            curve.halving > MOST_TO_HALVE ? `> × ${MOST_TO_HALVE}` : formatRatio(curve.halving),
        ];
        if (ahead) cells.push(result.best ? "best" : formatSeconds(result.aheadFrom));
        cells.push(formatCount(atTime(measured, time, (checkpoint) => checkpoint.passes, false)));
        cells.push(formatCount(atTime(measured, time, (checkpoint) => checkpoint.photons, false)));
        return cells;
    });
    const latest = `After ${formatSeconds(time)} of rendering, the latest time that all runs reached`;
    return table(time === null ? "At equal time" : latest, headers, rows);
}

function memoryTable(view, group) {
    const { devices } = view.bench;
    const headers = ["Run", "Peak", "Photons", "Pixels", "Scene", "Per photon", "Per pixel"];
    if (devices.length > 1) headers.push("Device");
    const rows = group.runs.map((run) => {
        const { memory, device } = view.scene.runs[run];
        const cells = [
            runName(view, run),
            formatBytes(peakMemory(view.scene.runs[run])),
            formatBytes(memory.photons),
            formatBytes(memory.pixels),
            formatBytes(memory.scene),
            formatBytes(memory.bytes_per_photon),
            formatBytes(memory.bytes_per_pixel),
        ];
        if (devices.length > 1) cells.push(devices[device].name);
        return cells;
    });
    return table("Device memory", headers, rows);
}

function referenceTable(view) {
    const { reference, regions } = view.scene;
    const rows = regions.map((_, i) => [
        regionName(view.scene, i),
        formatNumber(reference.noise[i]),
        formatNumber(reference.bias[i]),
        formatNumber(reference.floor[i]),
        formatNumber(3 * reference.floor[i]),
    ]);
    const headers = ["Region", "Noise", "Bias", "Floor", "Curves marked below"];
    return table("The reference’s own error, root mean square in XYZ", headers, rows);
}

function optionsTable(view) {
    const runs = view.scene.runs;
    const names = [...new Set(runs.flatMap((run) => Object.keys(run.options)))];
    const text = (value) => (typeof value === "object" ? JSON.stringify(value) : String(value ?? NONE));
    const rows = runs.map((run, i) => [
        runName(view, i),
        ...names.map((name) => text(run.options[name])),
        run.repeats.map((repeat) => repeat.seed).join(", "),
    ]);
    return table("Settings of each run", ["Run", ...names.map((name) => name.replaceAll("_", " ")), "seeds"], rows);
}

function facts(entries) {
    const rows = entries.filter(([, value]) => value !== null && value !== "");
    return element("dl", {}, ...rows.flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]));
}

function overheads(bench) {
    const repeats = bench.scenes.flatMap((scene) => scene.runs.flatMap((run) => run.repeats));
    const sum = (values) => values.reduce((total, value) => total + value, 0);
    const rendering = sum(repeats.map((repeat) => repeat.checkpoints.at(-1)?.seconds ?? 0));
    const percent = (seconds) => formatNumber((100 * seconds) / rendering, 2);
    const part = (seconds) => `${formatSeconds(seconds)} (${percent(seconds)} % of rendering)`;
    return {
        rendering: formatSeconds(rendering),
        build: part(sum(repeats.map((repeat) => repeat.build_seconds))),
        compare: part(sum(repeats.map((repeat) => repeat.compare_seconds))),
    };
}

// How many renders of the bench have not reached its time.
function unfinished(bench) {
    const runs = bench.scenes.flatMap((scene) => scene.runs);
    return runs.length * bench.repeats - runs.flatMap((run) => run.repeats).filter((repeat) => repeat.finished).length;
}

function benchFacts(bench) {
    const { machine } = bench;
    const spent = overheads(bench);
    const repeats = bench.scenes.flatMap((scene) => scene.runs).flatMap((run) => run.repeats);
    const seeds = [...new Set(repeats.map((repeat) => repeat.seed))].join(", ");
    const effort = `${formatSeconds(bench.seconds)} per repeat, ${bench.repeats} per run; ${spent.rendering} in all`;
    const deviceText = ({ name, platform, driver, opencl_c }) => [name, platform, driver, opencl_c].join(" · ");
    return facts([
        ["Command", element("code", {}, bench.command)],
        ["Started", bench.started],
        ["Version", `tristim ${bench.version}`],
        ["Processor", `${machine.processor}, ${machine.threads} threads, ${formatBytes(machine.memory)}`],
        ["System", machine.system],
        ...bench.devices.map((device) => ["Device", deviceText(device)]),
        ["Rendering", effort],
        ["Seeds", seeds],
        ["Kernels and pilot passes", `${spent.build}, not in the times above`],
        ["Comparison with the reference", `${spent.compare}, not in the times above`],
        ["Memory of the whole bench", formatBytes(bench.peak_process_memory)],
    ]);
}
