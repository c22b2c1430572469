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

/** Makes a control do nothing, and say why where it is pointed at, reached or clicked; or makes it work again. @param {string} id @param {string | false} why */
export function disable(id, why) {
    const control = element(id);
    const words = control.closest("label, .buttons").querySelector(".why");
    control.setAttribute("aria-disabled", String(why !== false));
    control.title = why || "";
    if (words) words.textContent = why || "";
}

/** A linear colour as "#rrggbb" in sRGB. @param {number[]} color */
export const hex = (color) => `#${color.map((part) => Math.round(255 * encoded(Math.max(0, Math.min(1, part)))).toString(16).padStart(2, "0")).join("")}`;
/** @param {number} part from 0 to 1 */
const encoded = (part) => (part <= 0.0031308 ? 12.92 * part : 1.055 * part ** (1 / 2.4) - 0.055);
/** The linear part of a colour in sRGB (IEC 61966-2-1). @param {number} part from 0 to 1 */
const linear = (part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4);
/** "#rrggbb" in sRGB as a linear colour. @param {string} color */
export const linearColor = (color) => [1, 3, 5].map((at) => linear(parseInt(color.slice(at, at + 2), 16) / 255));

/** @param {number | null} x */
export const six = (x) => (x === null ? "inf" : Number(x.toPrecision(6)).toString());
/** @param {number[]} v */
export const vector = (v) => v.map(six).join(", ");

/** What an error says. @param {unknown} error */
export const words = (error) => (error instanceof Error ? error.message : String(error));

/** The longest name that is shown, in characters. */
const LONGEST_NAME = 100;

/** A name from a file in one harmless line: what would break it or turn its direction is escaped. @param {string} name */
export function plain(name) {
    const short = name.length > LONGEST_NAME ? `${name.slice(0, LONGEST_NAME)}...` : name;
    return short.replace(/[\p{Cc}\p{Cf}\p{Zl}\p{Zp}]/gu, (sign) => `\\u{${sign.codePointAt(0)?.toString(16)}}`);
}

/** An object by its name, and its number behind. @param {{object: number, name?: string, shape?: string}} object */
export const named = ({ object, name, shape }) => `${plain(name || shape || "object")} (${object})`;

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
