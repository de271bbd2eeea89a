// What a design surface says at a place: shared by the page that granulens surface writes and by the explorer.

/// Functions of the surface's numbers: shares of an axis to places and back, and the value at a place.
function surfaceOf(data) {
  const digits = (value) => Number(value.toPrecision(4)).toString();
  // From a share of the axis to its place and back, and the cell that a place lies in.
  const ends = (axis) => [axis.places[0], axis.places[axis.places.length - 1]];
  const place = (axis, share) => { const [a, b] = ends(axis); return axis.linear ? a + share * (b - a) : a * Math.pow(b / a, share); };
  const share = (axis, at) => { const [a, b] = ends(axis); return axis.linear ? (at - a) / (b - a) : Math.log(at / a) / Math.log(b / a); };
  const cell = (axis, at) => {
    let k = 0;
    while (k + 2 < axis.places.length && axis.places[k + 1] <= at) k += 1;
    const [a, b] = [axis.places[k], axis.places[k + 1]];
    const part = b > a ? (axis.linear ? (at - a) / (b - a) : Math.log(at / a) / Math.log(b / a)) : 0;
    return [k, part];
  };
  // Logarithms of positive values are taken as linear within a cell, as the contour lines take them.
  const value = (x, y) => {
    const [i, p] = cell(data.x, x), [j, q] = cell(data.y, y), width = data.x.places.length;
    const corners = [[i, j], [i + 1, j], [i, j + 1], [i + 1, j + 1]].map(([a, b]) => data.values[b * width + a]);
    if (corners.some((corner) => corner === null)) return null;
    const [a, b, c, d] = corners.map(Math.log);
    return Math.exp((a * (1 - p) + b * p) * (1 - q) + (c * (1 - p) + d * p) * q);
  };
  const shownAt = (axis, at) => axis.linear ? String(axis.values[cell(axis, at)[0]]) : digits(at / axis.unit);
  return { digits, place, share, value, shownAt };
}
