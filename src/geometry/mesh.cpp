#include "geometry/mesh.h"

#include "kernels/large_vector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

namespace deformable {

// Elements that turn by less than 6 degrees make a smooth joint, those that turn by less than 32 degrees a blunt one: minus the cosine
// between their directions m.
static constexpr double SMOOTH = 0.9945, BLUNT = 0.85;
// Elements in a plane that is narrower than this part of the cutoff are facets: their blunt joints count as smooth.
static constexpr double FACET = 0.5;
// Planes go on beyond sharp corners as far as this many cutoffs from there.
static constexpr double BEYOND = 1.9;
// Of sines, and of lengths against the largest: rounding.
static constexpr double FLAT = 1e-9, THIN = 1e-10;
// Corners are one that are nearer to each other than this part of the size: numbers in single precision.
static constexpr double MERGED = 1e-7;
// Contacts at points that are nearer to each other than this part of the height are one.
static constexpr double SAME = 1e-9;

static std::string shown_point(int dimension, const Vector3 &x)
{
  const std::string plane = "(" + shown_number(x.x) + ", " + shown_number(x.y);
  return plane + (dimension == 3 ? ", " + shown_number(x.z) + ")" : ")");
}

/* ----------------------------------------------------------------------
   Elements, their sides and corners.
------------------------------------------------------------------------- */

std::string Mesh::build(int given_dimension, const std::vector<Vector3> &points, bool is_container,
                        const std::string &row)
{
  dimension = given_dimension;
  std::string problem = read_elements(points, row);
  if (!problem.empty()) return problem;
  join();
  problem = find_solid(is_container, row);
  if (!problem.empty()) return problem;
  look_at_corners();
  order.resize(elements.size());
  std::iota(order.begin(), order.end(), 0);
  grow_tree(0, static_cast<int>(order.size()));
  low = tree[0].low;
  high = tree[0].high;
  return "";
}

// Numbers of the corners that these points are, in `corners`: those in a cell of a grid that the point is in, or almost in.
std::vector<int> Mesh::merge(const std::vector<Vector3> &points)
{
  constexpr double CELL = 1e3;    // tolerances
  double size = 0.0;
  for (const Vector3 &x : points) size = std::max(size, length(x - points[0]));
  const double same = MERGED * size, cell = same > 0.0 ? CELL * same : 1.0;
  std::map<std::array<double, 3>, std::vector<int>> grid;
  std::vector<int> found;
  for (const Vector3 &x : points) {
    const auto first_near = [&] {
      const auto cell_of = [&](double at) { return std::floor(at / cell); };
      for (double i = cell_of(x.x - same); i <= cell_of(x.x + same); ++i)
        for (double j = cell_of(x.y - same); j <= cell_of(x.y + same); ++j)
          for (double k = cell_of(x.z - same); k <= cell_of(x.z + same); ++k) {
            const auto there = grid.find({i, j, k});
            if (there == grid.end()) continue;
            for (const int corner : there->second)
              if (length(corners[corner].x - x) <= same) return corner;
          }
      grid[{cell_of(x.x), cell_of(x.y), cell_of(x.z)}].push_back(static_cast<int>(corners.size()));
      corners.push_back({x, {}, {}, false, false, {}, {}});
      return static_cast<int>(corners.size()) - 1;
    };
    found.push_back(first_near());
  }
  return found;
}

std::string Mesh::read_elements(const std::vector<Vector3> &points, const std::string &row)
{
  if (points.empty()) return "has no " + row;
  for (std::size_t k = 0; k < points.size(); ++k)
    if (!std::isfinite(length(points[k])))
      return "has a corner of " + row + " " + std::to_string(k / dimension + 1) +
             " that is not finite: " + shown_point(dimension, points[k]);
  const std::vector<int> merged = merge(points);
  std::map<std::array<int, 2>, int> known_sides;
  for (std::size_t first = 0; first < points.size(); first += dimension) {
    const int index = static_cast<int>(elements.size());
    const std::string name = row + " " + std::to_string(index + 1);
    Element e{};
    for (int k = 0; k < dimension; ++k) {
      e.corner[k] = merged[first + k];
      corners[e.corner[k]].elements.push_back(index);
    }
    const auto point = [&](int k) { return corners[e.corner[k % dimension]].x; };
    const Vector3 a = point(0), ab = point(1) - a;
    e.at = a;
    if (dimension == 2) {
      if (!(length(ab) > 0.0))
        return "has no length at " + name + ": both of its ends are " + shown_point(2, a);
      e.n = (1.0 / length(ab)) * Vector3{-ab.y, ab.x, 0.0};
    } else {
      const Vector3 ac = point(2) - a, bc = ac - ab, area = cross(ab, ac);
      const double longest = std::max({dot(ab, ab), dot(ac, ac), dot(bc, bc)});
      if (!(length(area) > THIN * longest))
        return "has no area at " + name + ": its corners " + shown_point(3, a) + ", " +
               shown_point(3, a + ab) + " and " + shown_point(3, a + ac) + " are on a line";
      e.n = (1.0 / length(area)) * area;
    }
    for (int k = 0; k < dimension; ++k) {
      const int from = e.corner[k], to = e.corner[(k + 1) % dimension];
      const std::array<int, 2> ends = dimension == 2
                                          ? std::array{from, from}
                                          : std::array{std::min(from, to), std::max(from, to)};
      const auto [found, is_new] = known_sides.insert({ends, static_cast<int>(sides.size())});
      if (is_new) {
        Side side{};
        side.corner[0] = ends[0];
        side.corner[1] = ends[1];
        const Vector3 edge = corners[ends[1]].x - corners[ends[0]].x;
        if (dimension == 3) side.along = (1.0 / length(edge)) * edge;
        for (int end = 0; end < dimension - 1; ++end)
          corners[ends[end]].sides.push_back(static_cast<int>(sides.size()));
        sides.push_back(side);
      }
      Side &side = sides[e.side[k] = found->second];
      side.elements.push_back(index);
      side.place.push_back(k);
      const Vector3 inward = point(k + dimension - 1) - corners[ends[0]].x,
                    in = dimension == 2 ? inward : across(inward, side.along);
      e.in[k] = (1.0 / length(in)) * in;
    }
    elements.push_back(e);
  }
  return "";
}

/* ----------------------------------------------------------------------
   What is joined: elements in one plane, and what a contact rolls along without
   an end, on either side.
------------------------------------------------------------------------- */

// Length of a segment, area of a triangle.
double Mesh::size_of(const Element &e) const
{
  const Vector3 ab = corners[e.corner[1]].x - e.at, ac = corners[e.corner[dimension - 1]].x - e.at;
  return dimension == 2 ? length(ab) : 0.5 * length(cross(ab, ac));
}

static constexpr double FAR = std::numeric_limits<double>::infinity();
static Vector3 least(const Vector3 &a, const Vector3 &b)
{
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}

static int root_of(std::vector<int> &parent, int k)
{
  while (parent[k] != k) k = parent[k] = parent[parent[k]];
  return k;
}

static void unite(std::vector<int> &parent, int a, int b)
{
  a = root_of(parent, a);
  b = root_of(parent, b);
  parent[std::max(a, b)] = std::min(a, b);
}

void Mesh::join()
{
  const int n = static_cast<int>(elements.size());
  std::vector<int> key[2], plane(n);    // key: of front and back of each
  for (std::vector<int> &each : key) {
    each.resize(2 * n);
    std::iota(each.begin(), each.end(), 0);
  }
  std::iota(plane.begin(), plane.end(), 0);
  for (Side &side : sides) {
    const int first = side.elements[0];
    if (side.elements.size() == 1)    // around an end
      for (std::vector<int> &each : key) unite(each, 2 * first, 2 * first + 1);
    if (side.elements.size() != 2) continue;
    const int second = side.elements[1];
    const Element &e = elements[first], &f = elements[second];
    const Vector3 &m = e.in[side.place[0]], &other = f.in[side.place[1]];
    const Vector3 axis = dimension == 2 ? Vector3{0, 0, 1} : side.along;
    const bool e_turns = dot(axis, cross(m, e.n)) > 0.0,
               f_turns = dot(axis, cross(other, f.n)) > 0.0;
    const bool is_narrow = e_turns == (dot(axis, cross(m, other)) > 0.0);    // in front of e
    const bool is_smooth = -dot(m, other) > SMOOTH;
    side.is_blunt = -dot(m, other) > BLUNT;
    side.is_turned = e_turns == f_turns;
    side.is_flat = length(m + other) < FLAT;
    for (const int back : {0, 1}) {
      side.is_concave[back] = is_narrow == (back == 0);
      side.is_sharp[back] = side.is_concave[back] && !is_smooth;
      has_sharp = has_sharp || side.is_sharp[back];
      const int there = 2 * second + (side.is_turned ? 1 - back : back);
      if (!side.is_sharp[back]) unite(key[0], 2 * first + back, there);
      if (!side.is_sharp[back] || side.is_blunt) unite(key[1], 2 * first + back, there);
    }
    if (side.is_flat) unite(plane, first, second);
  }
  std::vector<double> area(n, 0.0);
  std::vector<Vector3> lowest(n, {FAR, FAR, FAR}), highest(n, {-FAR, -FAR, -FAR});
  for (int k = 0; k < n; ++k) {
    Element &e = elements[k];
    e.plane = root_of(plane, k);
    for (const int facets : {0, 1})
      for (const int back : {0, 1}) e.key[facets][back] = root_of(key[facets], 2 * k + back);
    area[e.plane] += size_of(e);
    for (int c = 0; c < dimension; ++c) {
      lowest[e.plane] = least(lowest[e.plane], corners[e.corner[c]].x);
      highest[e.plane] = -least(-highest[e.plane], -corners[e.corner[c]].x);
    }
  }
  for (Element &e : elements)
    e.width = area[e.plane] / (dimension == 2 ? 1.0 : length(highest[e.plane] - lowest[e.plane]));
}

/* ----------------------------------------------------------------------
   On which side of it a closed surface has particles, whatever way its elements
   face: its volume V > 0 tells,
     d V = sum of n.x over the surface.
------------------------------------------------------------------------- */

std::string Mesh::find_solid(bool is_container, const std::string &row)
{
  std::vector<int> facing(elements.size(), 0);    // 1 or -1, so that all face the same way
  for (std::size_t start = 0; start < elements.size(); ++start) {
    if (facing[start] != 0) continue;
    std::vector<int> body = {static_cast<int>(start)};
    facing[start] = 1;
    const Vector3 *open = nullptr;
    bool has_inside = true;
    double volume = 0.0, size = 0.0;
    const Vector3 origin = elements[start].at;
    for (std::size_t at = 0; at < body.size(); ++at) {
      const Element &e = elements[body[at]];
      for (int k = 0; k < dimension; ++k) {
        const Side &side = sides[e.side[k]];
        if (side.elements.size() != 2) {
          if (!open) open = &corners[side.corner[0]].x;
          continue;
        }
        const int other = side.elements[side.elements[0] == body[at] ? 1 : 0];
        const int turned = side.is_turned ? -facing[body[at]] : facing[body[at]];
        if (facing[other] == 0) {
          facing[other] = turned;
          body.push_back(other);
        }
        has_inside = has_inside && facing[other] == turned;
      }
      const double part = size_of(e) * dot(e.n, e.at - origin);
      volume += facing[body[at]] * part;
      size += std::fabs(part);
    }
    if (is_container && open)
      return "is open at " + shown_point(dimension, *open) + ", where " + row + " " +
             std::to_string(start + 1) +
             " and what is joined to it end: a container must be closed";
    const bool is_solid = !open && has_inside && std::fabs(volume) > FLAT * size;
    if (is_container && !is_solid)
      return "has no inside: " + row + " " + std::to_string(start + 1) +
             " and what is joined to it enclose nothing";
    if (is_solid) enclosed += std::fabs(volume) / dimension;
    for (const int k : body)
      elements[k].solid = is_solid ? facing[k] * ((volume > 0.0) == is_container ? -1 : 1) : 0;
  }
  return "";
}

// Which corners are no corners, but lie in a plane or an edge; and the way out of what is solid: there the mean normal, weighted
// by angles, decides (Baerentzen and Aanaes, IEEE Trans. Vis. Comput. Graph. 11, 243, 2005).
void Mesh::look_at_corners()
{
  for (Side &side : sides)
    for (const int k : side.elements) side.away = side.away + elements[k].solid * elements[k].n;
  first_part = 2 * static_cast<int>(elements.size());
  if (dimension == 2) return;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    Corner &corner = corners[c];
    std::vector<Vector3> edges;
    for (const int s : corner.sides) {
      const Side &side = sides[s];
      if (!side.is_flat)
        edges.push_back((side.corner[0] == static_cast<int>(c) ? 1.0 : -1.0) * side.along);
    }
    corner.is_flat = edges.empty();
    corner.is_straight = edges.size() == 2 && length(edges[0] + edges[1]) < FLAT;
    if (corner.is_straight) corner.along = edges[0];
    for (const int k : corner.elements) {
      const Element &e = elements[k];
      int at = 0;
      while (e.corner[at] != static_cast<int>(c)) ++at;
      const Vector3 a = corners[e.corner[(at + 1) % 3]].x - corner.x,
                    b = corners[e.corner[(at + 2) % 3]].x - corner.x;
      const double angle = std::atan2(length(cross(a, b)), dot(a, b));
      corner.away = corner.away + angle * e.solid * e.n;
    }
  }
}

/* ----------------------------------------------------------------------
   A tree of boxes: each is divided across its longest side, at the middle
   element.
------------------------------------------------------------------------- */

void Mesh::grow_tree(int begin, int end)
{
  constexpr int LEAF = 4;
  const int node = static_cast<int>(tree.size());
  tree.push_back({{FAR, FAR, FAR}, {-FAR, -FAR, -FAR}, begin, end, 0});
  for (int k = begin; k < end; ++k)
    for (int c = 0; c < dimension; ++c) {
      const Vector3 &x = corners[elements[order[k]].corner[c]].x;
      tree[node].low = least(tree[node].low, x);
      tree[node].high = -least(-tree[node].high, -x);
    }
  if (end - begin <= LEAF) return;
  const Vector3 size = tree[node].high - tree[node].low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto place = [&](int k) {
    double sum = 0.0;
    for (int c = 0; c < dimension; ++c) sum += component(corners[elements[k].corner[c]].x, axis);
    return sum;
  };
  const int middle = (begin + end) / 2;
  std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end,
                   [&](int a, int b) { return std::pair(place(a), a) < std::pair(place(b), b); });
  grow_tree(begin, middle);
  tree[node].second = static_cast<int>(tree.size());
  grow_tree(middle, end);
}

// Calls visitor(element) for those whose box is nearer than the root of `square`, which the visitor may lower.
template <class Visitor>
void Mesh::visit(const Vector3 &x, double &square, Visitor &&visitor) const
{
  const auto distance = [&](int node) {
    double sum = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double at = component(x, axis);
      const double out = std::max(
          {component(tree[node].low, axis) - at, at - component(tree[node].high, axis), 0.0});
      sum += out * out;
    }
    return sum;
  };
  int stack[64], size = 0;    // as deep as 2^60 elements
  stack[size++] = 0;
  while (size > 0) {
    const int node = stack[--size];
    if (!(distance(node) <= square)) continue;
    const Node &box = tree[node];
    if (box.second == 0) {
      for (int k = box.begin; k < box.end; ++k) visitor(order[k]);
      continue;
    }
    const int first = node + 1;
    const bool swapped = distance(box.second) < distance(first);
    stack[size++] = swapped ? first : box.second;
    stack[size++] = swapped ? box.second : first;    // the nearer one comes first
  }
}

/* ----------------------------------------------------------------------
   The nearest point of one element; whether a side or a corner is nearer than
   all that meets in it.
------------------------------------------------------------------------- */

Mesh::Near Mesh::nearest_on(int element, const Vector3 &x) const
{
  const Element &e = elements[element];
  Near near = {element, x - dot(e.n, x - e.at) * e.n, std::numeric_limits<double>::infinity()};
  bool is_inside = true;
  for (int k = 0; k < dimension; ++k) {
    if (inside(e, k, x) > 0.0) continue;
    is_inside = false;
    const Side &side = sides[e.side[k]];
    int part = part_of_side(e.side[k]);
    Vector3 foot = corners[side.corner[0]].x;
    if (dimension == 3) {
      const double along = beyond(side, 0, x);
      if (!(along > 0.0)) {
        part = part_of_corner(side.corner[0]);
      } else if (!(beyond(side, 1, x) > 0.0)) {
        part = part_of_corner(side.corner[1]);
        foot = corners[side.corner[1]].x;
      } else {
        foot = foot + along * side.along;
      }
    }
    const double square = dot(foot - x, foot - x);
    if (square < near.square) near = {part, foot, square};
  }
  if (is_inside) near.square = dot(near.foot - x, near.foot - x);
  return near;
}

bool Mesh::is_minimum(const Side &side, const Vector3 &x) const
{
  if (dimension == 3 && !(beyond(side, 0, x) > 0.0 && beyond(side, 1, x) > 0.0)) return false;
  for (std::size_t n = 0; n < side.elements.size(); ++n)
    if (inside(elements[side.elements[n]], side.place[n], x) > 0.0) return false;
  return true;
}

bool Mesh::is_minimum(int corner, const Vector3 &x) const
{
  return std::all_of(corners[corner].sides.begin(), corners[corner].sides.end(), [&](int s) {
    return !(beyond(sides[s], sides[s].corner[0] == corner ? 0 : 1, x) > 0.0);
  });
}

/* ----------------------------------------------------------------------
   A contact at an element, a side or a corner.
------------------------------------------------------------------------- */

SurfacePoint Mesh::point_of(int part, const Vector3 &x) const
{
  const int side = part - part_of_side(0), corner = part - part_of_corner(0);
  if (side < 0) {
    const Element &e = elements[part];
    const double above = dot(e.n, x - e.at);
    const double out = e.solid != 0 ? e.solid : above < 0.0 ? -1.0 : 1.0;
    return {-out * e.n, out * above, 0.0, 0.0, {}};
  }
  Vector3 foot, along, away;
  bool is_line = false;
  if (dimension == 2 || corner < 0) {
    const Side &s = sides[side];
    if (s.is_flat) return point_of(s.elements[0], x);
    is_line = dimension == 3;
    along = s.along;
    foot = corners[s.corner[0]].x;
    if (is_line) foot = foot + dot(along, x - foot) * along;
    away = s.away;
  } else {
    const Corner &c = corners[corner];
    if (c.is_flat) return point_of(c.elements[0], x);
    is_line = c.is_straight;
    along = c.along;
    foot = c.x;
    if (is_line) foot = foot + dot(along, x - foot) * along;
    away = c.away;
  }
  const Vector3 to = foot - x;
  const double distance = length(to), height = dot(away, to) > 0.0 ? -distance : distance;
  const double turn = 1.0 / height;
  return {turn * to, height, turn, is_line ? -turn : 0.0, along};
}

// Its element, as the one that faces the center most.
Mesh::Contact Mesh::contact_at(int part, const Vector3 &x) const
{
  const SurfacePoint point = point_of(part, x);
  const int side = part - part_of_side(0), corner = part - part_of_corner(0);
  int facing = part;
  if (side >= 0) {
    double most = -1.0;
    for (const int k :
         dimension == 2 || corner < 0 ? sides[side].elements : corners[corner].elements) {
      const double faces = std::fabs(dot(elements[k].n, point.n));
      if (!(faces > most)) continue;
      most = faces;
      facing = k;
    }
  }
  return {0, part, facing, point};
}

Mesh::Contact Mesh::nearest(const Vector3 &x) const
{
  Near found = {0, {}, std::numeric_limits<double>::infinity()};
  visit(x, found.square, [&](int k) {
    const Near near = nearest_on(k, x);
    if (near.square < found.square) found = near;
  });
  return contact_at(found.part, x);
}

/* ----------------------------------------------------------------------
   All contacts. The nearest point is one in any case, whatever rounding says of
   the tests above. Of contacts that are joined and have about the same direction
   the nearest one counts.
------------------------------------------------------------------------- */

void Mesh::find_contacts(const Vector3 &x, double cutoff, std::vector<Contact> &found) const
{
  found.clear();
  std::vector<int> beside;
  Near nearest = {-1, {}, cutoff * cutoff};
  double square = (has_sharp ? BEYOND * BEYOND : 1.0) * nearest.square;
  const auto add = [&](int part) {
    const Contact contact = contact_at(part, x);
    if (std::fabs(contact.point.height) < cutoff) found.push_back(contact);
  };
  const double facet = FACET * cutoff;
  const auto key_of = [&](const Contact &c, bool of_facets) {
    const Element &e = elements[c.element];
    return e.key[of_facets][dot(e.n, c.point.n) > 0.0 ? 1 : 0];
  };
  const auto is_facet = [&](const Contact &c) { return elements[c.element].width < facet; };
  visit(x, square, [&](int k) {
    const Near near = nearest_on(k, x);
    if (!(near.square < square)) return;
    if (near.square < nearest.square) nearest = near;
    if (near.part == k) return add(k);
    if (has_sharp) beside.push_back(k);
    const Element &e = elements[k];
    for (int n = 0; n < dimension; ++n) {
      const Side &side = sides[e.side[n]];
      if (side.elements[0] == k && is_minimum(side, x)) add(part_of_side(e.side[n]));
      if (dimension == 3 && corners[e.corner[n]].elements[0] == k && is_minimum(e.corner[n], x))
        add(part_of_corner(e.corner[n]));
    }
  });
  const auto is_before = [](const Contact &a, const Contact &b) {
    return std::pair(std::fabs(a.point.height), a.part) <
           std::pair(std::fabs(b.point.height), b.part);
  };
  if (nearest.part < 0) return;
  add(nearest.part);
  std::sort(found.begin(), found.end(), is_before);
  const auto foot = [](const Contact &c) { return c.point.height * c.point.n; };
  std::size_t kept = 0;
  for (const Contact &contact : std::vector<Contact>(found)) {
    const double same = SAME * std::fabs(contact.point.height);
    if (std::none_of(found.begin(), found.begin() + kept, [&](const Contact &nearer) {
          const bool facets = is_facet(nearer) || is_facet(contact);
          return (key_of(nearer, facets) == key_of(contact, facets) &&
                  dot(nearer.point.n, contact.point.n) > (facets ? BLUNT : SMOOTH)) ||
                 length(foot(nearer) - foot(contact)) <= same;
        }))
      found[kept++] = contact;
  }
  found.resize(kept);
  // what is seen from its solid side is behind something else
  if (!found.empty())
    found.erase(std::remove_if(found.begin() + 1, found.end(),
                               [](const Contact &c) { return c.point.height < 0.0; }),
                found.end());
  for (std::size_t before = 0; before < found.size();) {
    before = found.size();
    for (const int k : beside) go_on(k, x, cutoff, found);
  }
  std::vector<int> features;    // of several that are joined each has one of its own
  for (Contact &contact : found)
    features.push_back(contact.feature = key_of(contact, is_facet(contact)));
  for (Contact &contact : found)
    if (std::count(features.begin(), features.end(), contact.feature) > 1)
      contact.feature = first_part + contact.part;
}

/* ----------------------------------------------------------------------
   An element beyond a sharp side with another one, as long as that one has a
   contact in its plane, where the foot is or as it goes on, too. It ends where
   the side ends, but in the corner of a pit.
------------------------------------------------------------------------- */

// Whether all sides that meet in a corner are concave, or flat.
bool Mesh::is_pit(const Corner &corner, const Vector3 &x) const
{
  return std::all_of(corner.sides.begin(), corner.sides.end(), [&](int s) {
    const Side &side = sides[s];
    return side.elements.size() == 2 &&
           (side.is_flat || side.is_concave[!is_front(elements[side.elements[0]], x)]);
  });
}

void Mesh::go_on(int element, const Vector3 &x, double cutoff, std::vector<Contact> &found) const
{
  const auto is_there = [&](int plane) {
    return std::any_of(found.begin(), found.end(), [&](const Contact &c) {
      return c.part == c.element && elements[c.part].plane == plane;
    });
  };
  const Element &e = elements[element];
  if (is_there(e.plane)) return;
  for (int k = 0; k < dimension; ++k) {
    const Side &side = sides[e.side[k]];
    if (side.elements.size() != 2 || inside(e, k, x) > 0.0) continue;
    bool is_beside = true;
    for (const int end : {0, 1})
      is_beside = is_beside && (dimension == 2 || beyond(side, end, x) >= 0.0 ||
                                is_pit(corners[side.corner[end]], x));
    if (!is_beside) continue;
    const Element &first = elements[side.elements[0]], &second = elements[side.elements[1]];
    const bool is_back = !is_front(first, x);
    if (!side.is_sharp[is_back] || is_front(second, x) != (is_back == side.is_turned)) continue;
    const Element &other = side.elements[0] == element ? second : first;
    if (side.is_blunt && std::min(e.width, other.width) < FACET * cutoff) continue;
    if (!is_there(other.plane)) continue;
    const Contact contact = contact_at(element, x);
    if (std::fabs(contact.point.height) < cutoff) found.push_back(contact);
    return;
  }
}

std::vector<Vector3> Mesh::edges() const
{
  std::vector<Vector3> ends;
  for (const Side &side : sides)
    if (!side.is_flat)
      for (const int corner : side.corner) ends.push_back(corners[corner].x);
  return ends;
}

double Mesh::bytes() const
{
  double sum = bytes_of(elements, sides, corners, order, tree);
  for (const Side &side : sides) sum += bytes_of(side.elements, side.place);
  for (const Corner &corner : corners) sum += bytes_of(corner.sides, corner.elements);
  return sum;
}

}    // namespace deformable
