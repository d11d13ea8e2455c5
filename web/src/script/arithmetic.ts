// Numbers as typed into fields: "1.5", "2*3", "(1+2)/4".

export interface NumberLimits {
    low?: number;
    high?: number;
    whole?: boolean;
}

/** A number, or one sentence that says why the text is not a number. */
export type NumberRead = { value: number } | { errorText: string };

const kMaxShown = 24; // maximum number of characters of the typed text in a message
const kMaxDepth = 100; // maximum depth of nested brackets and signs
const kToken = /\s*(?:((?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)|([-+*/^()]))\s*/y;

class ParseError extends Error {}

function tokensOf(text: string): (number | string)[] {
    const tokens: (number | string)[] = [];
    kToken.lastIndex = 0;
    while (kToken.lastIndex < text.length) {
        const match = kToken.exec(text);
        if (!match) {
            throw new ParseError();
        }
        tokens.push(match[1] === undefined ? match[2] : Number(match[1]));
    }
    return tokens;
}

/** Recursive descent parser: sum, product, sign, power, number or brackets. */
class Parser {
    private at = 0;
    private depth = 0;

    constructor(private readonly tokens: readonly (number | string)[]) {}

    whole(): number {
        const value = this.sum();
        if (this.at < this.tokens.length) {
            throw new ParseError();
        }
        return value;
    }

    private accept(...signs: string[]): string | null {
        const token = this.tokens[this.at];
        if (typeof token === "string" && signs.includes(token)) {
            ++this.at;
            return token;
        }
        return null;
    }

    private sum(): number {
        let value = this.product();
        for (let sign = this.accept("+", "-"); sign; sign = this.accept("+", "-")) {
            value += sign === "+" ? this.product() : -this.product();
        }
        return value;
    }

    private product(): number {
        let value = this.signed();
        for (let sign = this.accept("*", "/"); sign; sign = this.accept("*", "/")) {
            const factor = this.signed();
            value = sign === "*" ? value * factor : value / factor;
        }
        return value;
    }

    private signed(): number {
        if (++this.depth > kMaxDepth) {
            throw new ParseError();
        }
        const sign = this.accept("+", "-");
        const value = sign ? this.signed() : this.power();
        --this.depth;
        return sign === "-" ? -value : value;
    }

    private power(): number {
        const base = this.atom();
        return this.accept("^") ? base ** this.signed() : base;
    }

    private atom(): number {
        if (this.accept("(")) {
            const value = this.sum();
            if (!this.accept(")")) {
                throw new ParseError();
            }
            return value;
        }
        const token = this.tokens[this.at++];
        if (typeof token !== "number") {
            throw new ParseError();
        }
        return token;
    }
}

/** Returns the value of an arithmetic expression; null if the text is not an expression. The value may be infinite or NaN. */
export function computed(text: string): number | null {
    try {
        const tokens = tokensOf(text);
        const value = new Parser(tokens).whole();
        return tokens.length === 1 ? value : Number(value.toPrecision(15)); // so that 0.1+0.2 is 0.3
    } catch (error) {
        if (error instanceof ParseError) {
            return null;
        }
        throw error;
    }
}

function rangeText({ low, high, whole }: NumberLimits): string {
    const type = whole ? "a whole number" : "a number";
    if (low !== undefined && high !== undefined) {
        return `${type} from ${low} to ${high}`;
    }
    return low !== undefined ? `${type} of at least ${low}` : high !== undefined ? `${type} of at most ${high}` : type;
}

/** Reads a number that was typed into a field. */
export function readNumber(text: string, limits: NumberLimits = {}): NumberRead {
    const typed = text.trim();
    const shown = `"${typed.length > kMaxShown ? `${typed.slice(0, kMaxShown)}…` : typed}"`;
    if (/\d,\d/.test(typed)) {
        return { errorText: `${shown} has a comma; write a decimal point, as in 1.5.` };
    }
    const value = computed(typed);
    if (value === null || Number.isNaN(value)) {
        return { errorText: `${shown} is not a number.` };
    }
    if (!Number.isFinite(value)) {
        return { errorText: `${shown} is too large.` };
    }
    const { low = -Infinity, high = Infinity, whole } = limits;
    const fits = value >= low && value <= high && (!whole || Number.isInteger(value));
    return fits ? { value } : { errorText: `Enter ${rangeText(limits)}, not ${shown}.` };
}
