// @ts-check
// The line that says what the page does, and what went wrong.

import { element } from "./dom.js";

/** An error stays for so long, in milliseconds, though pictures go on coming. */
const HELD = 5_000;
let heldUntil = 0;

/** @param {string} text @param {boolean} isError */
export function say(text, isError) {
    if (!isError && performance.now() < heldUntil) return;
    heldUntil = isError ? performance.now() + HELD : 0;
    element("message").textContent = text;
    element("message").classList.toggle("error", isError);
    if (isError) announce(text);
}

/** Says it to those who do not see. @param {string} text */
export function announce(text) {
    element("announcement").textContent = text;
}
