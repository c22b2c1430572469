// @ts-check
// The line that says what the page does, and what went wrong.

import { element } from "./dom.js";

/** What a person is to read stays for so long, in milliseconds, though pictures go on coming. */
const HELD = 5_000;
let heldUntil = 0;
/** Says what was to be said meanwhile. */
let later = 0;

/** @param {string} text @param {boolean} isError */
export function say(text, isError) {
    clearTimeout(later);
    const wait = heldUntil - performance.now();
    if (isError || wait <= 0) show(text, isError, isError);
    else later = setTimeout(() => show(text, false, false), wait);
}

/** Says why something does nothing. @param {string} why */
export const explain = (why) => show(why, false, true);

/** @param {string} text @param {boolean} isError @param {boolean} isHeld */
function show(text, isError, isHeld) {
    heldUntil = isHeld ? performance.now() + HELD : 0;
    element("message").textContent = text;
    element("message").classList.toggle("error", isError);
    if (isHeld) announce(text);
}

/** Says it to those who do not see. @param {string} text */
export function announce(text) {
    element("announcement").textContent = text;
}

/** @param {string} text */
export async function copy(text) {
    try {
        await navigator.clipboard.writeText(text);
        explain("Copied.");
    } catch {
        say("The browser did not let the page copy: mark the text and copy it.", true);
    }
}
