// The part of Wavefront's .obj that surfaces need: vertices, faces, and names of sets of faces.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "io/number_text.h"
#include "io/obj_parse.h"
#include "io/polygon_parse.h"

namespace vdb_offset {
namespace {

using Words = std::vector<std::string_view>;

/// One kind of statement that names faces: `g`, `o` or `usemtl`.
struct Naming {
  NameList names;
  std::string current;  // empty: none
  std::vector<int> of_faces;

  /// Of several groups a face is in each, and in one family: that of all their names. Names with
  /// blanks, which some writers make, look the same.
  void name(const Words& words) {
    current = words.size() > 1 ? words[1] : "";
    for (std::size_t n = 2; n < words.size(); ++n) (current += ' ') += words[n];
  }
  void add_face(const std::string& name) { of_faces.push_back(names.index_of(name)); }
  /// Whether faces differ in it.
  bool tells_apart() const {
    return std::any_of(of_faces.begin(), of_faces.end(), [&](int n) { return n != of_faces[0]; });
  }
  bool given() const { return names.names().size() > 1 || !names.names()[0].empty(); }
};

class ObjFaces {
 public:
  explicit ObjFaces(const PolygonText& text) : text_(text), builder_(text.name, "line") {}

  void take(const Words& words, std::size_t line);
  PolygonMesh finish();

 private:
  void add_vertex(const Words& words, std::size_t line);
  void add_face(const Words& words, std::size_t line);
  void set_families(const Naming& naming);

  const PolygonText& text_;
  PolygonBuilder builder_;
  Naming groups_, objects_, materials_;
  std::vector<int> corners_;
  std::size_t furthest_ = 0;  // vertex of a face that was not yet read, counted from 1
  std::size_t furthest_line_ = 0;
};

/// A word that is no number makes a vertex that no face may use: some writers leave "1.#IND". What
/// follows the three is a weight or a colour.
void ObjFaces::add_vertex(const Words& words, std::size_t line) {
  if (words.size() < 4) {
    throw text_.at_line(line, fmt::format("a vertex of {} numbers", words.size() - 1),
                        "'v' takes three: x, y and z");
  }
  Vec3 point;
  for (int c = 0; c < 3; ++c) {
    point[c] = parse_real(words[static_cast<std::size_t>(c) + 1])
                   .value_or(std::numeric_limits<double>::quiet_NaN());
  }
  builder_.add_point(point, line);
}

void ObjFaces::add_face(const Words& words, std::size_t line) {
  if (words.size() < 4) {
    throw text_.at_line(line, fmt::format("'f' names {} vertices", words.size() - 1),
                        "it takes 3 at least");
  }
  corners_.clear();
  for (std::size_t n = 1; n < words.size(); ++n) {
    const std::size_t count = builder_.points();
    const std::optional<std::size_t> vertex = obj_vertex(words[n], count);
    if (!vertex || *vertex >= static_cast<std::size_t>(std::numeric_limits<int>::max())) {
      throw text_.at_line(line,
                          fmt::format("{} is no vertex, of the {} so far", quoted(words[n]), count),
                          "indices count from 1, or back from -1");
    }
    if (*vertex >= count && *vertex >= furthest_) {
      furthest_ = *vertex + 1;
      furthest_line_ = line;
    }
    corners_.push_back(static_cast<int>(*vertex));
  }
  builder_.add_face(corners_);
  groups_.add_face(groups_.current.empty() ? objects_.current : groups_.current);
  objects_.add_face(objects_.current);
  materials_.add_face(materials_.current);
}

void ObjFaces::take(const Words& words, std::size_t line) {
  const std::string_view word = words[0];
  if (word == "v") {
    add_vertex(words, line);
  } else if (word == "f") {
    add_face(words, line);
  } else if (word == "o" || word == "g" || word == "usemtl") {
    (word == "g" ? groups_ : word == "o" ? objects_ : materials_).name(words);
  }
}

/// Faces that nothing names are in OBJ's group "default".
void ObjFaces::set_families(const Naming& naming) {
  NameList named;
  std::vector<int> index;  // of each name; "default" may be one that is given
  for (const std::string& name : naming.names.names()) {
    index.push_back(named.index_of(name.empty() ? "default" : name));
  }
  std::vector<int> of_faces;
  for (const int n : naming.of_faces) of_faces.push_back(index[static_cast<std::size_t>(n)]);
  builder_.set_families(named, std::move(of_faces));
}

PolygonMesh ObjFaces::finish() {
  if (furthest_ > builder_.points()) {
    throw text_.at_line(
        furthest_line_,
        fmt::format("{} is no vertex, of the {} of the file", furthest_, builder_.points()),
        "complete the file");
  }
  if (builder_.faces() == 0) return builder_.finish();
  const std::array<const Naming*, 3> namings{&groups_, &objects_, &materials_};
  auto chosen = std::ranges::find_if(namings, &Naming::tells_apart);
  if (chosen == namings.end()) chosen = std::ranges::find_if(namings, &Naming::given);
  if (chosen != namings.end()) set_families(**chosen);
  return builder_.finish();
}

}  // namespace

PolygonMesh parse_obj_faces(const PolygonText& text) {
  ObjFaces faces(text);
  for_obj_lines(text.bytes, [&](const Words& words, std::size_t line) { faces.take(words, line); });
  return faces.finish();
}

}  // namespace vdb_offset
