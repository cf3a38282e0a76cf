// Vectors in space. In the plane of the particles z = 0.

#ifndef DEFORMABLE_VECTOR3_H
#define DEFORMABLE_VECTOR3_H

#include <cmath>

namespace deformable {

struct Vector3 {
  double x, y, z;
};

inline Vector3 operator+(const Vector3 &a, const Vector3 &b)
{
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vector3 operator-(const Vector3 &a, const Vector3 &b)
{
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vector3 operator-(const Vector3 &a)
{
  return {-a.x, -a.y, -a.z};
}
inline Vector3 operator*(double s, const Vector3 &a)
{
  return {s * a.x, s * a.y, s * a.z};
}
inline Vector3 operator/(const Vector3 &a, double s)
{
  return {a.x / s, a.y / s, a.z / s};
}
inline double dot(const Vector3 &a, const Vector3 &b)
{
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vector3 cross(const Vector3 &a, const Vector3 &b)
{
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(const Vector3 &a)
{
  return std::sqrt(dot(a, a));
}
// The part of a vector across a unit vector.
inline Vector3 across(const Vector3 &a, const Vector3 &n)
{
  return a - dot(a, n) * n;
}

inline double &component(Vector3 &v, int axis)
{
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}
inline double component(const Vector3 &v, int axis)
{
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

// The shortest rotation that takes the unit vector n to m:
//   R v = v - (n + m).v/(1 + n.m) (n + m) + 2 (n.v) m
// It has no axis where m = -n: then v stays. If n is not known (0), what is left is the part of v across m.
inline Vector3 turned(const Vector3 &v, const Vector3 &n, const Vector3 &m)
{
  const double cosine = dot(n, m);
  if (dot(n, n) == 0.0) return across(v, m);
  if (!(cosine > -1.0)) return v;
  const Vector3 both = n + m;
  return v - dot(both, v) / (1.0 + cosine) * both + 2.0 * dot(n, v) * m;
}

}    // namespace deformable

#endif
