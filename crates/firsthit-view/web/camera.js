// @ts-check
// The camera that the mouse, fingers and keys move. It turns about a point, with the scene's up upwards.

/** @typedef {import("./engine.js").FlatCamera} FlatCamera */
/** @typedef {[number, number, number]} Vector */

/** @param {Vector} a @param {Vector} b @returns {Vector} */
export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
/** @param {Vector} a @param {Vector} b @returns {Vector} */
export const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
/** @param {number} s @param {Vector} a @returns {Vector} */
export const times = (s, a) => [s * a[0], s * a[1], s * a[2]];
/** @param {Vector} a @param {Vector} b */
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
/** @param {Vector} a @param {Vector} b @returns {Vector} */
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
/** @param {Vector} a */
export const length = (a) => Math.hypot(a[0], a[1], a[2]);
/** @param {Vector} a @returns {Vector} */
export const unit = (a) => times(1 / length(a), a);

/** A vector turned about an axis of length one (Rodrigues). @param {Vector} v @param {Vector} axis @param {number} angle in radians @returns {Vector} */
export function turned(v, axis, angle) {
    const [sine, cosine] = [Math.sin(angle), Math.cos(angle)];
    const along = times(dot(axis, v) * (1 - cosine), axis);
    return add(add(times(cosine, v), times(sine, cross(axis, v))), along);
}

/** The steepest that a turn leaves the camera, in radians. */
const STEEPEST = (89.5 / 180) * Math.PI;

/** The share of the picture that a framed scene takes. */
const MARGIN = 0.95;

export class OrbitCamera {
    /** @param {FlatCamera} given where it begins @param {Vector} up the scene's @param {[Vector, Vector] | null} bounds the scene's box */
    constructor(given, up, bounds) {
        this.sceneUp = unit(up);
        this.bounds = bounds;
        this.position = this.aim = this.up = /** @type {Vector} */ ([0, 0, 1]);
        /** @type {"perspective" | "orthographic"} */
        this.projection = "perspective";
        /** @type {"eye" | "viewplane"} */
        this.rayStart = "eye";
        this.focal = this.height = this.distance = 1;
        /** What it was given, of which the picture's width is kept to the last digit. @type {FlatCamera} */
        this.given = given;
        this.take(given);
        this.home = this.saved();
    }

    /** Takes another camera. @param {FlatCamera} given */
    take(given) {
        this.given = given;
        this.position = /** @type {Vector} */ (given.position);
        this.aim = /** @type {Vector} */ (given.aim);
        this.up = /** @type {Vector} */ (given.up);
        this.projection = given.projection;
        this.rayStart = given.ray_start;
        this.focal = given.focal_length;
        this.height = given.height;
        const ahead = dot(minus(this.middle(), this.position), unit(this.aim));
        this.distance = ahead > 0 ? ahead : this.size();
    }

    saved() {
        const { position, aim, up, projection, rayStart, focal, height, distance, given } = this;
        return { position, aim, up, projection, rayStart, focal, height, distance, given };
    }

    /** The scene's middle. @returns {Vector} */
    middle() {
        return this.bounds ? times(0.5, add(this.bounds[0], this.bounds[1])) : [0, 0, 0];
    }

    /** The scene's diagonal. */
    size() {
        return this.bounds ? length(minus(this.bounds[1], this.bounds[0])) || 1 : 1;
    }

    /** The point that it turns about. @returns {Vector} */
    pivot() {
        return add(this.position, times(this.distance, unit(this.aim)));
    }

    /** Its axes: right and upwards. @returns {[Vector, Vector]} */
    axes() {
        const right = unit(cross(this.aim, this.up));
        return [right, cross(right, unit(this.aim))];
    }

    /** The height of the picture at the pivot, in scene units. */
    span() {
        return this.projection === "perspective" ? (this.height * this.distance) / this.focal : this.height;
    }

    /** The width of a pixel as a share of its height. */
    pixelShape() {
        const { rows, columns, width, height } = this.given;
        return (width * rows) / (height * columns);
    }

    /** The camera as engines take it. @param {number} rows @param {number} columns @returns {FlatCamera} */
    flat(rows, columns) {
        const { position, aim, up, projection, rayStart, focal, height, given } = this;
        const isGiven = rows === given.rows && columns === given.columns && height === given.height;
        const width = isGiven ? given.width : (height * columns * this.pixelShape()) / rows;
        return { position, aim, up, projection, ray_start: rayStart, focal_length: focal, width, height, rows, columns };
    }

    /** Turns about the pivot. @param {number} right @param {number} upwards in radians */
    orbit(right, upwards) {
        const pivot = this.pivot();
        this.#turn(-right, upwards);
        this.position = minus(pivot, times(this.distance, this.aim));
    }

    /** @param {number} about the scene's up @param {number} pitch of the camera */
    #turn(about, pitch) {
        let aim = turned(unit(this.aim), this.sceneUp, about);
        const elevation = Math.asin(Math.max(-1, Math.min(1, -dot(aim, this.sceneUp))));
        const wanted = Math.max(-STEEPEST, Math.min(STEEPEST, elevation + pitch));
        let right = cross(aim, this.sceneUp);
        if (length(right) < 1e-6) right = turned(this.axes()[0], this.sceneUp, about);
        aim = turned(aim, unit(right), elevation - wanted);
        this.aim = unit(aim);
        this.up = this.sceneUp;
    }

    /** Moves it so that the pivot's plane goes along with the cursor. @param {number} right @param {number} down in heights of the picture */
    pan(right, down) {
        const [x, y] = this.axes();
        const span = this.span();
        const way = add(times(-right * span * this.pixelShape(), x), times(down * span, y));
        this.position = add(this.position, way);
    }

    /** Comes nearer, or goes away, and keeps what is under the cursor. @param {number} factor on the distance @param {number} x @param {number} y of the cursor, in heights of the picture from its middle, to the right and upwards */
    zoom(factor, x, y) {
        const span = this.span();
        const [right, up] = this.axes();
        const beside = add(times(x * span * this.pixelShape() * (1 - factor), right), times(y * span * (1 - factor), up));
        if (this.projection === "perspective") {
            const pivot = add(this.pivot(), beside);
            this.distance *= factor;
            this.position = minus(pivot, times(this.distance, unit(this.aim)));
        } else {
            this.position = add(this.position, beside);
            this.height *= factor;
        }
    }

    /** Goes on seeing the whole width that it began with, in a stage that is narrower. @param {number} aspect columns to rows */
    keepWidth(aspect) {
        const wanted = this.given.width / (aspect * this.pixelShape());
        if (wanted <= this.height) return;
        this.height = wanted;
        this.home = this.saved();
    }

    /** Brings the scene's box into the picture, its middle in the picture's. @param {number} aspect columns to rows */
    frame(aspect) {
        const axes = [...this.axes(), unit(this.aim)];
        const middle = this.middle();
        // The corners seen from the middle: to the right, upwards and ahead.
        const corners = this.corners().map((corner) => axes.map((axis) => dot(minus(corner, middle), axis)));
        const wide = aspect * this.pixelShape();
        const least = this.size() / 100;
        if (this.projection === "perspective") {
            const tall = (MARGIN * this.height) / 2 / this.focal;
            const fit = (/** @type {number[]} */ [x, y, z]) => Math.max(Math.abs(x) / (tall * wide), Math.abs(y) / tall, least) - z;
            this.distance = Math.max(...corners.map(fit));
        } else {
            const fit = (/** @type {number[]} */ [x, y]) => Math.max(Math.abs(x) / wide, Math.abs(y), least);
            this.height = (2 / MARGIN) * Math.max(...corners.map(fit));
            this.distance = Math.max(this.distance, this.size());
        }
        // What is between the eye and the viewplane would not be seen.
        const nearest = Math.max(...corners.map(([, , z]) => -z));
        if (this.rayStart === "viewplane") this.distance = Math.max(this.distance, this.focal + nearest + least);
        this.position = minus(middle, times(this.distance, unit(this.aim)));
    }

    /** The corners of the scene's box. @returns {Vector[]} */
    corners() {
        const [low, high] = this.bounds ?? [[-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]];
        return [...Array(8).keys()].map((k) => /** @type {Vector} */ ([0, 1, 2].map((axis) => ((k >> axis) & 1 ? high : low)[axis])));
    }

    /** Looks along a direction. @param {Vector} aim @param {Vector} up @param {number} aspect */
    lookAlong(aim, up, aspect) {
        [this.aim, this.up] = [aim, up];
        this.frame(aspect);
    }

    /** Between perspective and parallel rays, with the same picture at the pivot. @param {"perspective" | "orthographic"} projection */
    project(projection) {
        if (projection === this.projection) return;
        const span = this.span();
        this.projection = projection;
        this.height = projection === "perspective" ? (span * this.focal) / this.distance : span;
    }

    /** Back to where it began. */
    reset() {
        Object.assign(this, this.home);
    }

    /** Where a point of the world is in the picture, in pixels; null behind the camera. @param {Vector} point @param {number} rows @param {number} columns @returns {[number, number] | null} */
    pixelOf(point, rows, columns) {
        const way = minus(point, this.position);
        const [right, up] = this.axes();
        const depth = dot(way, unit(this.aim));
        if (this.projection === "perspective" && depth <= 0) return null;
        const { width, height } = this.flat(rows, columns);
        const far = this.projection === "perspective" ? depth / this.focal : 1;
        return [columns / 2 + (dot(way, right) * columns) / (width * far), rows / 2 - (dot(way, up) * rows) / (height * far)];
    }
}
