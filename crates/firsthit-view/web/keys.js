// @ts-check
// Keys: the list of what they do, and the list that is shown.

import { element, make } from "./dom.js";

/** @typedef {{about: string, act: () => void}} Key */

/** The steps of an arrow key, to the right and upwards; null of other keys. @param {string} key @returns {[number, number] | null} */
export function arrow(key) {
    const ways = /** @type {Record<string, [number, number]>} */ ({ ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] });
    return ways[key] ?? null;
}

/** Whether a key is for what has the focus, and not for the page. @param {KeyboardEvent} event */
function isForElement(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || element("keys").open) return true;
    const target = /** @type {HTMLElement} */ (event.target);
    const takesArrows = target instanceof HTMLInputElement && target.type === "range";
    const isTyping = target instanceof HTMLInputElement && target.type !== "checkbox" && !(takesArrows && !arrow(event.key));
    const isAtControl = ["BUTTON", "SUMMARY"].includes(target.tagName) && (event.key === "Enter" || event.key === " ");
    return isTyping || isAtControl || ["SELECT", "TEXTAREA"].includes(target.tagName);
}

/** Does what a key says. @param {KeyboardEvent} event @param {Record<string, Key>} keys @param {(key: string, isShifted: boolean) => boolean} steer takes what moves the camera */
export function press(event, keys, steer) {
    if (isForElement(event)) return;
    const key = keys[event.key] ?? keys[event.key.toLowerCase()];
    if (!steer(event.key, event.shiftKey)) {
        if (!key) return;
        key.act();
    }
    event.preventDefault();
}

/** @param {Record<string, Key>} keys */
export function listKeys(keys) {
    const others = [["drag, arrows", "turn"], ["Shift drag, right drag, Shift arrows", "move"], ["wheel, + and -", "nearer, farther"], ["click", "keep a point: two and more are measured"]];
    const own = Object.entries(keys).map(([key, { about }]) => [key.length === 1 ? key.toUpperCase() : key, about]);
    for (const [key, about] of [...others, ...own]) {
        const line = make("div");
        line.append(make("dt", key), make("dd", about));
        element("key-list").append(line);
    }
}
