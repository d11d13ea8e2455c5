// Text for numbers and lengths, and round numbers in an interval.
import { roundStep } from "../tools/kit/vector";

const kUnits: [number, string][] = [
    [1000, "km"],
    [1, "m"],
    [0.01, "cm"],
    [0.001, "mm"],
    [1e-6, "µm"],
    [1e-9, "nm"],
];

/** The number with a maximum of significant digits, without trailing zeros. */
export function shortNumber(value: number, digits = 3): string {
    if (!Number.isFinite(value)) {
        return "–";
    }
    const size = Math.abs(value);
    if (size !== 0 && (size >= 1e7 || size < 1e-4)) {
        return value
            .toExponential(digits - 1)
            .replace("e+", "e")
            .replace("-", "−")
            .replace("e-", "e−");
    }
    const places = size === 0 ? 0 : Math.max(digits - 1 - Math.floor(Math.log10(size)), 0);
    return value
        .toFixed(places)
        .replace(/(\.\d*?)0+$/, "$1")
        .replace(/\.$/, "")
        .replace(/^-(?=0$)/, "")
        .replace("-", "−");
}

/** A length in a suitable unit: "3.21 m", "4.5 cm". */
export function lengthText(metres: number, digits = 3): string {
    const size = Math.abs(metres);
    const [unit, name] = kUnits.find(([one]) => size >= one * 0.9999) ?? (size === 0 ? [1, "m"] : kUnits[kUnits.length - 1]);
    return `${shortNumber(metres / unit, digits)} ${name}`;
}

/** Round numbers from `low` to `high`, at most `most`. */
export function ticks(low: number, high: number, most: number): number[] {
    if (!(high > low)) {
        return [];
    }
    const step = roundStep((high - low) / most);
    const first = Math.ceil(low / step - 1e-9);
    const last = Math.floor(high / step + 1e-9);
    return Array.from({ length: last - first + 1 }, (_, i) => (first + i) * step).map((value) => Number(value.toPrecision(12)));
}

/** The largest round length below `most`: 1, 2 or 5 times a power of ten. */
export function roundBelow(most: number): number {
    const power = 10 ** Math.floor(Math.log10(most));
    const part = most / power;
    return power * (part >= 5 ? 5 : part >= 2 ? 2 : 1);
}
