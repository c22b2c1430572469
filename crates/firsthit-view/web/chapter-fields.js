// @ts-check
// The chapter's letters and their numbers, as fields: vectors in three columns, width beside height.

import { cross, length } from "./camera.js";
import { element, make, six } from "./dom.js";
import { formula } from "./letters.js";
import { aligned, trimmed } from "./readout.js";
import { say } from "./status.js";

/** @typedef {import("./camera.js").Vector} Vector */

/** The most rows and columns: the chapter's pixels are to be seen. */
const MOST_PIXELS = 512;
const WANTED = `z_p, w and h are positive, M and N whole and at most ${MOST_PIXELS}; x_c, u_c and v_up are three numbers each, and v_up is not along u_c.`;
const VECTORS = { x_c: "where the camera is", u_c: "where it looks", v_up: "which way is up" };
const NUMBERS = { w: "width of the viewplane", h: "height of the viewplane", z_p: "distance of the viewplane", M: "rows of pixels", N: "columns of pixels" };
const ROWS = [["w", "h", "z_p"], ["N", "M"]];
const COUNTS = ["M", "N"];
/** A field has room for so many digits. */
const DIGITS = 6;

export class ChapterFields {
    /** What is shown has fewer digits than what is known. @type {Map<any, {text: string, number: number}>} */
    #known = new Map();

    /** @param {() => void} changed */
    constructor(changed) {
        const field = (/** @type {string} */ name, /** @type {string} */ about) => {
            const input = make("input", "", { id: `chapter-${name}`, inputmode: "decimal", "aria-label": about });
            input.addEventListener("change", changed);
            return input;
        };
        const letter = (/** @type {string} */ name) => {
            const shown = make("span", "", { "aria-hidden": "true" });
            shown.append(formula(name));
            return shown;
        };
        const line = (/** @type {string} */ kind, /** @type {Node[]} */ parts) => {
            const made = make("div", "", { class: kind });
            made.append(...parts);
            return made;
        };
        const vectors = Object.entries(VECTORS).map(([name, about]) => line("vector", [letter(name), ...[..."xyz"].map((axis) => field(`${name}-${axis}`, `${about}: ${axis}`))]));
        const lengths = ROWS.map((names) => line("lengths", names.flatMap((name) => [letter(name), field(name, NUMBERS[/** @type {keyof typeof NUMBERS} */ (name)])])));
        element("chapter-fields").replaceChildren(...vectors, ...lengths);
        for (const name of Object.keys(VECTORS)) {
            // Three numbers that are pasted at once go to the three fields.
            element(`chapter-${name}-x`).addEventListener("paste", (/** @type {ClipboardEvent} */ event) => {
                const words = (event.clipboardData?.getData("text") ?? "").split(/[\s,[\]()]+/).filter((word) => word !== "");
                if (words.length !== 3) return;
                event.preventDefault();
                this.#inputs(name).forEach((input, k) => (input.value = words[k]));
                changed();
            });
        }
    }

    /** @param {string} name @returns {any[]} */
    #inputs(name) {
        return name in VECTORS ? [..."xyz"].map((axis) => element(`chapter-${name}-${axis}`)) : [element(`chapter-${name}`)];
    }

    /** @param {Record<string, number[]>} all numbers by their letters */
    write(all) {
        for (const [name, numbers] of Object.entries(all)) {
            const texts = name in VECTORS ? trimmed(aligned(numbers, DIGITS)) : numbers.map(six);
            this.#inputs(name).forEach((input, k) => {
                // Whoever types is not disturbed.
                if (document.activeElement === input) return;
                input.value = texts[k];
                this.#known.set(input, { text: texts[k], number: numbers[k] });
            });
        }
    }

    /** What the fields say; marks what makes no sense, and is null then. @returns {Record<string, number[]> | null} */
    read() {
        /** @type {Record<string, number[]>} */
        const all = {};
        let isGood = true;
        for (const name of [...Object.keys(VECTORS), ...Object.keys(NUMBERS)]) {
            all[name] = this.#inputs(name).map((input) => {
                const known = this.#known.get(input);
                const value = input.value.trim() === "" ? NaN : known && known.text === input.value ? known.number : Number(input.value);
                const isCount = COUNTS.includes(name);
                const isSense = Number.isFinite(value) && (name in VECTORS || value > 0) && (!isCount || (Number.isInteger(value) && value <= MOST_PIXELS));
                input.setAttribute("aria-invalid", String(!isSense));
                isGood &&= isSense;
                return value;
            });
        }
        const [aim, up] = /** @type {Vector[]} */ ([all.u_c, all.v_up]);
        if (isGood && !(length(cross(aim, up)) > 1e-9 * length(aim) * length(up))) {
            for (const input of this.#inputs("v_up")) input.setAttribute("aria-invalid", "true");
            isGood = false;
        }
        if (!isGood) say(WANTED, true);
        return isGood ? all : null;
    }

    /** Whether a camera with so many pixels can be shown. @param {number} rows @param {number} columns */
    static isSmall(rows, columns) {
        return rows <= MOST_PIXELS && columns <= MOST_PIXELS;
    }
}
