// @ts-check
// Letters as books print them.

import { make } from "./dom.js";

/** A formula with its letters in italics, and what follows an underscore below them: `c_0 = x_c + z_p u_c`. @param {string} text @returns {DocumentFragment} */
export function formula(text) {
    const whole = document.createDocumentFragment();
    let end = 0;
    for (const found of text.matchAll(/\b([a-zA-Z])(?:_(\w+))?\b/g)) {
        const letter = make("var", found[1]);
        if (found[2]) letter.append(make("sub", found[2]));
        whole.append(text.slice(end, found.index), letter);
        end = found.index + found[0].length;
    }
    whole.append(text.slice(end));
    return whole;
}
