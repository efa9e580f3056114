// Equations of a two-link arm, its friction and its encoder. Written by engine/physics.py from
// ddlib's derivation and effects: change those, then run `python -m ddlib.widgets.engine.physics`.

// The nearest whole number, the even one of two that are as near.
function rint(x) {
  const near = Math.round(x);
  return near - x === 0.5 && near % 2 ? near - 1 : near;
}

// Torques (N m) of angles (rad), velocities (rad/s) and accelerations (rad/s^2).
function armTorque({ a, b, d, g1, g2 }, q1, q2, qd1, qd2, qdd1, qdd2) {
  const x0 = b*Math.cos(q2);
  const x1 = b*Math.sin(q2);
  const x2 = qdd1*x0;
  const x3 = d*qdd1 + d*qdd2 + g2*Math.sin(q1 + q2);
  return [g1*Math.sin(q1) - 2*qd1*qd2*x1 - (qd2*qd2)*x1 + qdd1*(a - d) + qdd2*x0 + 2*x2 + x3, (qd1*qd1)*x1 + x2 + x3];
}

// Accelerations (rad/s^2) under torques t1, t2 (N m).
function armAcceleration({ a, b, d, g1, g2 }, q1, q2, qd1, qd2, t1, t2) {
  const x0 = b*Math.cos(q2);
  const x1 = a + 2*x0;
  const x2 = d + x0;
  const x3 = 1/(d*x1 - (x2*x2));
  const x4 = g2*Math.sin(q1 + q2);
  const x5 = b*Math.sin(q2);
  const x6 = -(qd1*qd1)*x5 + t2 - x4;
  const x7 = -g1*Math.sin(q1) + 2*qd1*qd2*x5 + (qd2*qd2)*x5 + t1 - x4;
  return [x3*(d*x7 - x2*x6), x3*(x1*x6 - x2*x7)];
}

// Entries 11, 12 and 22 of the mass matrix (kg m^2).
function armMass({ a, b, d }, q2) {
  const x0 = b*Math.cos(q2);
  return [a + 2*x0, d + x0, d];
}

// Viscous and Coulomb friction (N m) of a joint at the velocity v (rad/s).
function frictionTorque(viscous, coulomb, smoothing, v) {
  return coulomb*Math.tanh(v/smoothing) + v*viscous;
}

// An angle (rad) as the encoder reads it.
function encoderReading(step, x) {
  return step*rint(x/step);
}
