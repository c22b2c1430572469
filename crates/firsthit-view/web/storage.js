// @ts-check
// What this tab keeps while the page is loaded again. A page that its window gives no memory does without.

/** @param {string} key @returns {string | null} */
export function remembered(key) {
    try {
        return sessionStorage.getItem(key);
    } catch {
        return null;
    }
}

/** @param {string} key @param {string} text */
export function remember(key, text) {
    try {
        sessionStorage.setItem(key, text);
    } catch { /* it is gone with the page then */ }
}
