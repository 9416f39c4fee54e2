// Numbers as people read them, and elements. All text goes in by textContent: names come from users.

const NONE = "–";

// Significant digits, without an exponent for everyday sizes.
function formatNumber(value, digits = 3) {
    if (value === null || value === undefined || !Number.isFinite(value)) return NONE;
    if (value === 0) return "0";
    const magnitude = Math.abs(value);
    if (magnitude >= 1e-4 && magnitude < 1e6) {
        const rounded = Number(value.toPrecision(digits));
        const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(Math.abs(rounded))));
        return rounded.toFixed(Math.min(decimals, 8)).replace("-", "−");
    }
    const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
    const superscript = [...String(Number(exponent))].map((c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[c])).join("");
    return `${mantissa} × 10${superscript}`.replace("-", "−");
}

// "0.02" rather than "0.0200": for round values.
function formatRound(value, digits = 2) {
    const text = formatNumber(value, digits);
    return text.includes("×") || !text.includes(".") ? text.replace(/^1\.0 × /, "") : text.replace(/\.?0+$/, "");
}

function formatSeconds(value) {
    if (value === null || value === undefined || !Number.isFinite(value)) return NONE;
    const [size, unit] = value < 120 ? [1, "s"] : value < 7200 ? [60, "min"] : [3600, "h"];
    return `${formatRound(value / size, 3)} ${unit}`;
}

function formatCount(value) {
    if (value === null || value === undefined) return NONE;
    if (value >= 1e9) return `${formatNumber(value / 1e9)} G`;
    if (value >= 1e6) return `${formatNumber(value / 1e6)} M`;
    return Math.round(value).toLocaleString("en").replaceAll(",", "\u202f"); // a narrow space
}

function formatBytes(value) {
    if (value === null || value === undefined) return NONE;
    const units = ["B", "KiB", "MiB", "GiB", "TiB"];
    let unit = 0;
    while (value >= 1024 && unit + 1 < units.length) {
        value /= 1024;
        unit += 1;
    }
    return `${formatNumber(value)} ${units[unit]}`;
}

function formatRatio(value) {
    return value === null || !Number.isFinite(value) ? NONE : `× ${formatNumber(value, value >= 10 ? 3 : 2)}`;
}

// An element with attributes and children: elements, or values that become text.
function element(tag, attributes = {}, ...children) {
    const made = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) {
        if (name === "style") made.style.cssText = value;
        else if (value !== null && value !== false) made.setAttribute(name, value === true ? "" : value);
    }
    made.append(...children.filter((child) => child !== null));
    return made;
}

// A table of header texts and rows, each a list of cells: elements or text; the first cell of a row heads it.
function table(caption, headers, rows) {
    const head = element("tr", {}, ...headers.map((text) => element("th", { scope: "col" }, text)));
    const body = rows.map(([first, ...others]) => {
        const heading = element("th", { scope: "row" }, first);
        return element("tr", {}, heading, ...others.map((cell) => element("td", {}, cell)));
    });
    const made = element("table", { "aria-label": caption }, element("thead", {}, head), element("tbody", {}, ...body));
    return element(
        "div", { class: "titled" },
        element("p", { class: "caption" }, caption),
        element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": caption }, made)
    );
}

function median(values) {
    const sorted = values.filter((value) => value !== null).sort((a, b) => a - b);
    if (sorted.length === 0) return null;
    const half = Math.floor(sorted.length / 2);
    return sorted.length % 2 ? sorted[half] : (sorted[half - 1] + sorted[half]) / 2;
}

// The value at x of samples at ascending xs, along straight lines in x and y or, if `log`, in their logarithms as far
// as values are positive. None outside of the samples.
function interpolate(xs, ys, x, log) {
    // Times that were computed from the same samples may differ in their last digits.
    const clamped = Math.min(Math.max(x, xs[0]), xs[xs.length - 1]);
    if (xs.length === 0 || Math.abs(clamped - x) > 1e-9 * Math.abs(x)) return null;
    const after = Math.max(1, xs.findIndex((sample) => sample >= clamped));
    if (xs.length === 1 || xs[after - 1] === clamped) return ys[after - 1];
    const scale = log ? Math.log : (value) => value;
    const t = (scale(clamped) - scale(xs[after - 1])) / (scale(xs[after]) - scale(xs[after - 1]));
    const [a, b] = [ys[after - 1], ys[after]];
    return log && a > 0 && b > 0 ? a * (b / a) ** t : a * (1 - t) + b * t;
}
