// How sharp the picture is: in full while it rests, and while it moves as sharp as the machine draws fluently.

const SLOW = 36, FAST = 22;  // ms between the browser's frames
const STEP = 0.75, LEAST = 0.5;
const RESTS_AFTER = 400, JUDGED_AFTER = 1500, AGAIN_AFTER = 20000;  // ms

export class Pace {
  constructor() {
    this.interval = 1000 / 60;  // ms, smoothed
    this.moving = 1;  // sharpness while it moves
    this.last = this.changed = this.movedAt = -1e9;
    this.notBefore = 0;  // when less, or more, may be tried
    this.before = null;  // {sharpness, interval} before the last step
  }

  /** That the picture has changed by what an eye would see. */
  moved(now) { this.movedAt = now; }

  /** Once in each of the browser's frames, `drew`: whether the one before was drawn. Sharpness, 0.5 to 1. */
  next(now, drew) {
    const taken = now - this.last;
    this.last = now;
    if (now - this.movedAt > RESTS_AFTER) return 1;
    // A browser that slept has not been slow.
    if (drew && taken < 1000) this.interval += 0.1 * (taken - this.interval);
    if (now - this.changed > JUDGED_AFTER && now > this.notBefore) this.judge(now);
    return this.moving;
  }

  judge(now) {
    const {before} = this;
    this.before = null;
    if (before && before.sharpness > this.moving && this.interval > 0.9 * before.interval) {
      // Something else takes the time: then a blurred picture helps nobody.
      this.moving = before.sharpness;
      this.notBefore = now + AGAIN_AFTER;
    } else if (this.interval > SLOW && this.moving > LEAST) {
      this.set(Math.max(this.moving * STEP, LEAST), now);
    } else if (this.interval < FAST && this.moving < 1) {
      this.set(Math.min(this.moving / STEP, 1), now);
      this.notBefore = now + AGAIN_AFTER;
    }
  }

  set(sharpness, now) {
    this.before = {sharpness: this.moving, interval: this.interval};
    this.moving = sharpness;
    this.changed = now;
  }
}
