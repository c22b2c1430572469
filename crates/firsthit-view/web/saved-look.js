// @ts-check
// What a tab has kept of a page. Anybody may have written it, for another scene too: it is taken whole, or not at all.

/** @param {any} x @param {number} count */
const isVector = (x, count) => Array.isArray(x) && x.length === count && x.every(Number.isFinite);
/** @param {any} x */
const isDirection = (x) => isVector(x, 3) && x.some((/** @type {number} */ part) => part !== 0);
/** @param {any} x */
const isLength = (x) => Number.isFinite(x) && x > 0;

/** @param {any} camera */
const isCamera = ({ position, aim, up, projection, rayStart, focal, height, distance, given }) =>
    isVector(position, 3) && isDirection(aim) && isDirection(up) &&
    ["perspective", "orthographic"].includes(projection) && ["eye", "viewplane"].includes(rayStart) &&
    [focal, height, distance, given.width, given.height, given.rows, given.columns].every(isLength);

/** @param {any} fields */
const areFields = (fields) => Object.values(fields).every((value) => ["string", "boolean"].includes(typeof value));

/** @param {any} objects @param {number} count */
function areObjects({ hidden, colors }, count) {
    const isObject = (/** @type {any} */ k) => Number.isInteger(k) && k >= 0 && k < count;
    const isColor = (/** @type {any} */ color) => isVector(color, 3) && color.every((/** @type {number} */ part) => part >= 0 && part <= 1);
    return hidden.every(isObject) && colors.every((/** @type {any} */ [object, color]) => isObject(object) && isColor(color));
}

/** What a text says that was kept, if all of it makes sense for a scene of so many objects. @param {string | null} text @param {number} count @returns {any} */
export function savedLook(text, count) {
    try {
        const saved = JSON.parse(text ?? "");
        const { camera, home, fields, objects, cut, ball } = saved;
        const isBall = [ball.x, ball.y].every(Number.isFinite) && (ball.direction === null || isDirection(ball.direction));
        const isCut = isDirection(cut.normal) && Number.isFinite(cut.offset) && areFields(cut.fields);
        const isSound = isCamera(camera) && isCamera(home) && areFields(fields) && areObjects(objects, count) && isCut && isBall;
        return isSound ? saved : null;
    } catch {
        return null;
    }
}
