// Equations of a two-link arm, its friction and its encoder: those of ddlib's dynamics and effects,
// with which tests/widgets/test_engine.py compares them. The arm has base parameters a, b, d
// (kg m^2) and gravity moments g1, g2 (N m).

// The nearest whole number, the even one of two that are as near.
export function rint(x) {
  const near = Math.round(x);
  return near - x === 0.5 && near % 2 ? near - 1 : near;
}

// Entries 11, 12 and 22 of the mass matrix (kg m^2).
export function armMass({ a, b, d }, q2) {
  const c = b * Math.cos(q2);
  return [a + 2 * c, d + c, d];
}

// Torques (N m) of angles (rad), velocities (rad/s) and accelerations (rad/s^2).
export function armTorque(arm, q1, q2, qd1, qd2, qdd1, qdd2) {
  const [m11, m12, m22] = armMass(arm, q2);
  const h = arm.b * Math.sin(q2);
  const g = arm.g2 * Math.sin(q1 + q2);
  const shoulder = arm.g1 * Math.sin(q1) + g - h * qd2 * (2 * qd1 + qd2);
  return [m11 * qdd1 + m12 * qdd2 + shoulder, m12 * qdd1 + m22 * qdd2 + h * qd1 * qd1 + g];
}

// Accelerations (rad/s^2) under torques t1, t2 (N m): the mass matrix solved by Cramer's rule.
export function armAcceleration({ a, b, d, g1, g2 }, q1, q2, qd1, qd2, t1, t2) {
  const c = b * Math.cos(q2);
  const h = b * Math.sin(q2);
  const g = g2 * Math.sin(q1 + q2);
  const left1 = t1 - g1 * Math.sin(q1) - g + h * qd2 * (2 * qd1 + qd2);
  const left2 = t2 - g - h * qd1 * qd1;
  const [m11, m12] = [a + 2 * c, d + c];
  const determinant = m11 * d - m12 * m12;
  return [(d * left1 - m12 * left2) / determinant, (m11 * left2 - m12 * left1) / determinant];
}

// Viscous and Coulomb friction (N m) of a joint at the velocity v (rad/s).
export function frictionTorque(viscous, coulomb, smoothing, v) {
  return viscous * v + coulomb * Math.tanh(v / smoothing);
}

// An angle (rad) as the encoder reads it.
export function encoderReading(step, x) {
  return step * rint(x / step);
}
