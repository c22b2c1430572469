// @ts-check
// Elements of the page. What files say goes in as text alone.

/** An element of index.html. @param {string} id @returns {any} */
export const element = (id) => document.getElementById(id);

/** A new element with a text. @param {string} tag @param {string} [text] @param {Record<string, string>} [attributes] @returns {any} */
export function make(tag, text = "", attributes = {}) {
    const made = document.createElement(tag);
    made.textContent = text;
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    return made;
}

/** Fills a list to choose from. @param {string} id @param {string[]} names */
export function offer(id, names) {
    element(id).replaceChildren(...names.map((name) => make("option", name, { value: name })));
}

/** Gives the user a file. @param {string} name @param {Blob} content */
export function download(name, content) {
    const address = URL.createObjectURL(content);
    make("a", "", { href: address, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

/** @param {number | null} x */
export const six = (x) => (x === null ? "inf" : Number(x.toPrecision(6)).toString());
/** @param {number[]} v */
export const vector = (v) => v.map(six).join(", ");

/** Three numbers of a text, with commas or blanks between; null where it has others. @param {string} text @returns {[number, number, number] | null} */
export function threeNumbers(text) {
    const words = text.split(/[\s,]+/).filter((word) => word !== "");
    const numbers = words.map(Number);
    return numbers.length === 3 && numbers.every(Number.isFinite) ? [numbers[0], numbers[1], numbers[2]] : null;
}

/** What an error says. @param {unknown} error */
export const words = (error) => (error instanceof Error ? error.message : String(error));

/** The longest name that is shown, in characters. */
const LONGEST_NAME = 100;

/** A name from a file in one harmless line: what would break it or turn its direction is escaped. @param {string} name */
export function plain(name) {
    const short = name.length > LONGEST_NAME ? `${name.slice(0, LONGEST_NAME)}...` : name;
    return short.replace(/[\p{Cc}\p{Cf}\p{Zl}\p{Zp}]/gu, (sign) => `\\u{${sign.codePointAt(0)?.toString(16)}}`);
}

/** The values of fields, and whether boxes are ticked, by their ids. @param {string[]} ids @returns {Record<string, string | boolean>} */
export function savedFields(ids) {
    return Object.fromEntries(ids.map((id) => [id, element(id).type === "checkbox" ? element(id).checked : element(id).value]));
}

/** Puts back what `savedFields` gave. @param {Record<string, string | boolean>} saved */
export function restoreFields(saved) {
    for (const [id, value] of Object.entries(saved)) {
        const field = element(id);
        if (!field) continue;
        if (typeof value === "boolean") field.checked = value;
        // Another page may have had other choices.
        else if (!field.options || [...field.options].some((/** @type {any} */ option) => option.value === value)) field.value = value;
    }
}
