// Vectors in space.

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

}    // namespace deformable

#endif
