#include "geometry/mesh_files.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <locale>
#include <sstream>

namespace deformable {

// Numbers do not depend on the locale of the process, which strtod would follow.
static bool read_number(const std::string &word, double &value)
{
  std::istringstream stream(word);
  stream.imbue(std::locale::classic());
  return (stream >> value) && stream.peek() == std::istringstream::traits_type::eof();
}

std::vector<Vector3> segments_of(std::vector<Vector3> points, bool is_container)
{
  const auto differ = [](const Vector3 &a, const Vector3 &b) { return a.x != b.x || a.y != b.y; };
  if (is_container && points.size() > 2 && differ(points.front(), points.back()))
    points.push_back(points.front());
  std::vector<Vector3> corners;
  for (std::size_t k = 1; k < points.size(); ++k) {
    corners.push_back(points[k - 1]);
    corners.push_back(points[k]);
  }
  return corners;
}

std::string read_chain(const std::string &text, std::vector<Vector3> &points)
{
  std::istringstream lines(text);
  int number = 0;
  bool may_have_names = true;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    line = line.substr(0, line.find('#'));
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c == ',' || c == ';' || c == '\r'; }, ' ');
    std::istringstream stream(line);
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    if (words.empty()) continue;
    Vector3 x = {};
    if (words.size() == 2 && read_number(words[0], x.x) && read_number(words[1], x.y))
      points.push_back(x);
    else if (!may_have_names)
      return "has no point x y in line " + std::to_string(number) + ", but '" + line + "'";
    may_have_names = false;
  }
  if (points.size() >= 2) return "";
  return "has " + std::to_string(points.size()) + " points: a chain has two or more";
}

static std::string read_text_stl(const std::string &text, std::vector<Vector3> &corners)
{
  std::istringstream stream(text);
  for (std::string word; stream >> word;) {
    if (word != "vertex") continue;
    std::string x[3];
    Vector3 corner = {};
    stream >> x[0] >> x[1] >> x[2];
    if (!read_number(x[0], corner.x) || !read_number(x[1], corner.y) ||
        !read_number(x[2], corner.z))
      return "has no vertex x y z in triangle " + std::to_string(corners.size() / 3 + 1) +
             ", but '" + x[0] + " " + x[1] + " " + x[2] + "'";
    corners.push_back(corner);
  }
  if (corners.empty() || corners.size() % 3 != 0)
    return "is no STL file: it has " + std::to_string(corners.size()) +
           " corners, and is not as long as a binary one";
  return "";
}

// A binary file has a head of 80 bytes, the number of triangles, and for each of them 12 floats (its normal and corners) and 2
// bytes, all with the lowest byte first. Its head may begin as text does: its length tells.
std::string read_stl(const std::string &bytes, std::vector<Vector3> &corners)
{
  constexpr std::size_t HEAD = 84, ROW = 50, NORMAL = 12;
  const auto word_at = [&](std::size_t at) {
    std::uint32_t word = 0;
    for (int k = 3; k >= 0; --k) word = word << 8 | static_cast<unsigned char>(bytes[at + k]);
    return word;
  };
  corners.clear();
  if (bytes.size() < HEAD || bytes.size() != HEAD + ROW * word_at(HEAD - 4))
    return read_text_stl(bytes, corners);
  for (std::size_t row = HEAD; row < bytes.size(); row += ROW)
    for (std::size_t at = row + NORMAL; at < row + ROW - 2; at += 12) {
      float x[3];
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t word = word_at(at + 4 * k);
        std::memcpy(&x[k], &word, sizeof word);
      }
      corners.push_back({x[0], x[1], x[2]});
    }
  return corners.empty() ? "has no triangles" : "";
}

}    // namespace deformable
