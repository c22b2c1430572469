// @ts-check
// Of many calls the newest.

import { words } from "./dom.js";
import { say } from "./status.js";

/** Does something for the newest of many calls: one at a time, and of those that wait the last. @template {any[]} T @param {(...given: T) => Promise<void>} act @param {AbortSignal} ended after which nothing is said any more @returns {(...given: T) => Promise<void>} */
export function newest(act, ended) {
    /** @type {T | null} */
    let next = null;
    let isAtIt = false;
    return async (...given) => {
        next = given;
        if (isAtIt) return;
        isAtIt = true;
        while (next) {
            const now = next;
            next = null;
            try {
                await act(...now);
            } catch (error) {
                if (!ended.aborted) say(words(error), true);
            }
        }
        isAtIt = false;
    };
}
