// @ts-check
// Names and their numbers: as many digits as a person reads, and all of them on a click.

import { element, make } from "./dom.js";

/** A row: its name, and numbers or a text. A number that is alone keeps its digits in step with those of its group. @typedef {{name: string | (() => Node), numbers?: number[], text?: string, swatch?: string, group?: number[]}} Row */

/** A person reads so many digits. */
const DIGITS = 6;
/** Whether all digits are shown. */
let isExact = false;
/** What is shown in each list. @type {Map<any, Row[]>} */
const shown = new Map();

/** Without the zeros that all of them end with. @param {string[]} texts */
export function trimmed(texts) {
    const zeros = texts.map((text) => (text.includes(".") && !text.includes("e") ? text.length - text.replace(/0+$/, "").length : 0));
    return texts.map((text) => text.slice(0, text.length - Math.min(...zeros)).replace(/\.$/, ""));
}

/** Numbers with as many decimals each: so many that the largest has the digits wanted. @param {number[]} numbers @param {number} [digits] @param {number[]} [group] that they go with @returns {string[]} */
export function aligned(numbers, digits = DIGITS, group = numbers) {
    const sizes = [...numbers, ...group].map(Math.abs).filter((size) => size > 0 && size < Infinity);
    const largest = Math.max(...sizes, 0);
    const before = largest > 0 ? Math.floor(Math.log10(largest)) + 1 : 1;
    const isPlain = before > -4 && before <= 9;
    return numbers.map((number) => {
        if (!Number.isFinite(number)) return Number.isNaN(number) ? "–" : number > 0 ? "inf" : "-inf";
        const text = isPlain ? number.toFixed(Math.max(0, Math.min(12, digits - Math.max(before, 1)))) : number.toExponential(digits - 1);
        return Number(text) === 0 ? text.replace("-", "") : text;
    });
}

/** A row of numbers that nothing is known of, where `count` is how many. @param {number} count */
export const unknown = (count) => Array.from({ length: count }, () => NaN);

/** Shows rows in a list. @param {any} list @param {Row[]} rows */
export function readOut(list, rows) {
    for (const other of shown.keys()) if (!other.isConnected) shown.delete(other);
    shown.set(list, rows);
    list.classList.toggle("exact", isExact);
    list.replaceChildren(...rows.map(row));
}

/** @param {Row} row */
function row({ name, numbers, text, swatch, group }) {
    const line = make("div", "", numbers && numbers.length > 1 ? {} : { class: "single" });
    const title = make("dt");
    title.append(typeof name === "string" ? name : name());
    line.append(title);
    if (numbers) {
        const texts = isExact ? numbers.map((number) => (Number.isNaN(number) ? "–" : number === Infinity ? "inf" : String(number))) : aligned(numbers, DIGITS, group);
        line.append(...texts.map((each) => make("dd", each)));
    } else {
        const words = make("dd", text, { class: "words" });
        if (swatch) {
            const square = make("i", "", { class: "swatch" });
            square.style.background = swatch;
            words.prepend(square);
        }
        line.append(words);
    }
    return line;
}

/** Shows all digits, or those that a person reads. */
function toggle() {
    isExact = !isExact;
    element("digits").setAttribute("aria-pressed", String(isExact));
    for (const [list, rows] of [...shown]) readOut(list, rows);
}

/** Lets the button and the numbers themselves show all digits. @param {AbortSignal} ended */
export function connectDigits(ended) {
    element("digits").setAttribute("aria-pressed", String(isExact));
    element("digits").addEventListener("click", toggle);
    const clicked = (/** @type {MouseEvent} */ event) => {
        const isNumber = event.target instanceof HTMLElement && event.target.matches(".readout dd:not(.words)");
        // Whoever marks a number wants to copy it.
        if (isNumber && getSelection()?.isCollapsed) toggle();
    };
    element("panel").addEventListener("click", clicked, { signal: ended });
}
