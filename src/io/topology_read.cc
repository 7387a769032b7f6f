// A document from anybody: every value is looked at before it is used, and nothing is allocated
// that the file does not hold.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "io/input_file.h"
#include "io/topology_words.h"
#include "vdb_offset/core/error.h"

namespace vdb_offset {
namespace {

namespace words = topology_words;
using Document = TopologyDocument;
using Json = nlohmann::json;

constexpr int kDeepest = 8;  // of what write_topology writes: 6
constexpr int kLargest = std::numeric_limits<int>::max();

/// A value and where it stands.
class Node {
 public:
  Node(const Json& value, const std::string& file, std::string pointer)
      : value_(value), file_(file), pointer_(std::move(pointer)) {}

  [[noreturn]] void refuse(const std::string& rule) const {
    constexpr std::size_t kShown = 40;
    std::string shown = value_.is_structured()
                            ? fmt::format("{} of {}", value_.type_name(), value_.size())
                            : value_.dump(-1, ' ', true, Json::error_handler_t::replace);
    if (shown.size() > kShown) shown = shown.substr(0, kShown) + "...";
    throw IoError(fmt::format("{}, at {}: is {}, but {}", file_,
                              pointer_.empty() ? "the top" : pointer_, shown, rule));
  }

  Node at(const char* key) const {
    if (!value_.is_object()) refuse("has to be an object");
    const auto found = value_.find(key);
    if (found == value_.end()) refuse(fmt::format("has to have \"{}\"", key));
    return {*found, file_, fmt::format("{}/{}", pointer_, key)};
  }
  bool has(const char* key) const { return value_.is_object() && value_.contains(key); }

  std::size_t size() const {
    if (!value_.is_array()) refuse("has to be a list");
    return value_.size();
  }
  Node operator[](std::size_t n) const {
    return {value_[n], file_, fmt::format("{}/{}", pointer_, n)};
  }
  void need_size(std::size_t wanted) const {
    if (size() != wanted) refuse(fmt::format("has to be a list of {}", wanted));
  }

  /// A whole number in [least, most].
  int whole(int least, int most) const {
    const auto rule = [&] {
      return fmt::format("has to be a whole number in [{}, {}]", least, most);
    };
    if (!value_.is_number_integer()) refuse(rule());
    const bool is_huge =
        value_.is_number_unsigned() && value_.get<std::uint64_t>() > std::uint64_t{kLargest};
    const auto value = is_huge ? std::int64_t{-1} : value_.get<std::int64_t>();
    if (is_huge || value < least || value > most) refuse(rule());
    return static_cast<int>(value);
  }
  /// An index of what there are `count` of; `least` -1: none too.
  int index(std::size_t count, int least = 0) const {
    const int value = whole(-1, kLargest);
    if (value < least || (value >= 0 && static_cast<std::size_t>(value) >= count)) {
      refuse(fmt::format("there are {} of them, from 0", count));
    }
    return value;
  }
  double real() const {
    if (!value_.is_number()) refuse("has to be a number");
    const double value = value_.get<double>();
    if (!std::isfinite(value)) refuse("has to be finite");
    return value;
  }
  bool flag() const {
    if (!value_.is_boolean()) refuse("has to be true or false");
    return value_.get<bool>();
  }
  std::string text() const {
    if (!value_.is_string()) refuse("has to be text");
    return value_.get<std::string>();
  }
  template <typename Value, std::size_t N>
  Value word(const std::array<std::string_view, N>& all) const {
    const auto found = value_.is_string()
                           ? std::ranges::find(all, value_.get_ref<const std::string&>())
                           : all.end();
    if (found == all.end()) refuse(fmt::format("has to be one of {}", fmt::join(all, ", ")));
    return static_cast<Value>(found - all.begin());
  }

 private:
  const Json& value_;
  const std::string& file_;
  std::string pointer_;
};

template <typename Read>
auto list_of(const Node& node, const Read& read) {
  std::vector<decltype(read(node))> out;
  const std::size_t count = node.size();
  out.reserve(count);
  for (std::size_t n = 0; n < count; ++n) out.push_back(read(node[n]));
  return out;
}

std::vector<int> indices(const Node& node, std::size_t count) {
  return list_of(node, [&](const Node& one) { return one.index(count); });
}

Vec3 vector(const Node& node) {
  node.need_size(3);
  return {node[0].real(), node[1].real(), node[2].real()};
}

Document::Grid grid(const Node& node, const Document& out) {
  Document::Grid one;
  one.name = node.at("name").text();
  one.family = node.at("family").text();
  one.role = node.at("role").word<Document::Role>(words::kRoles);
  one.boundary = node.at("boundary").text();
  if (node.has("body")) one.body = node.at("body").whole(0, kLargest);
  const bool is_grid = !node.has("faces");
  one.ni = node.at("ni").whole(2, kLargest);
  one.nj = node.at("nj").whole(is_grid ? 1 : 0, is_grid ? kLargest : 0);
  one.points = indices(node.at("points"), out.points_world.size());
  const std::uint64_t wanted =
      static_cast<std::uint64_t>(one.ni) * static_cast<std::uint64_t>(std::max(one.nj, 1));
  if (one.points.size() != wanted) {
    node.at("points").refuse(fmt::format("{} x {} points are {}", one.ni, one.nj, wanted));
  }
  if (is_grid) return one;
  one.faces = list_of(node.at("faces"), [&](const Node& face) {
    const std::size_t corners = face.size();
    if (corners != 3 && corners != 4) face.refuse("has to be a list of 3 or 4");
    std::array<int, 4> f{-1, -1, -1, -1};
    for (std::size_t c = 0; c < corners; ++c) f[c] = face[c].index(one.points.size());
    return f;
  });
  if (one.faces.empty()) node.at("faces").refuse("polygons have faces");
  return one;
}

Document::BoundaryPlane plane(const Node& node) {
  Document::BoundaryPlane one{node.at("name").text(), node.at("given").flag(),
                              vector(node.at("point")), vector(node.at("normal")),
                              node.has("rest") && node.at("rest").flag()};
  if (one.normal.isZero(0)) node.at("normal").refuse("has to have a length");
  return one;
}

Document::Edge edge(const Node& node, const Document& out) {
  Document::Edge one;
  one.kind = node.at("kind").word<Document::EdgeKind>(words::kEdges);
  one.curve = node.at("curve").index(out.curves.size());
  one.degenerate = node.at("degenerate").flag();
  const Node ends = node.at("vertices");
  ends.need_size(2);
  const std::vector<int>& curve = out.curves[static_cast<std::size_t>(one.curve)];
  for (std::size_t n = 0; n < 2; ++n) {
    one.vertices[n] = ends[n].index(out.vertices.size());
    const int point = n == 0 ? curve.front() : curve.back();
    if (out.vertices[static_cast<std::size_t>(one.vertices[n])] != point) {
      ends[n].refuse(
          fmt::format("its curve ends in point {}, which this one does not stand on", point));
    }
  }
  return one;
}

/// Around: each edge begins where the one before it ends.
std::vector<Document::EdgeUse> loop(const Node& node, const Document& out) {
  std::vector<Document::EdgeUse> uses = list_of(node, [&](const Node& one) {
    one.need_size(2);
    const int sense = one[1].whole(-1, 1);
    if (sense == 0) one[1].refuse("has to be 1 or -1");
    return Document::EdgeUse{one[0].index(out.edges.size()), sense < 0};
  });
  const auto vertex = [&](const Document::EdgeUse& use, bool last) {
    return out.edges[static_cast<std::size_t>(use.edge)].vertices[use.reversed != last ? 1 : 0];
  };
  for (std::size_t n = 0; n < uses.size(); ++n) {
    const Document::EdgeUse& next = uses[(n + 1) % uses.size()];
    if (vertex(uses[n], true) != vertex(next, false)) {
      node[n].refuse(
          fmt::format("the next edge of the loop, {}, does not begin where it ends", next.edge));
    }
  }
  return uses;
}

Document::Face face(const Node& node, const Document& out) {
  Document::Face one;
  one.kind = node.at("kind").word<Document::FaceKind>(words::kFaces);
  one.surface = node.at("surface").index(out.surfaces.size(), -1);
  one.interface = node.at("interface").index(out.interfaces.size(), -1);
  one.boundary_face = node.at("boundary_face").index(out.boundary_faces.size(), -1);
  if ((one.interface < 0) == (one.boundary_face < 0)) {
    node.refuse("has to have an interface or a boundary face, not both");
  }
  one.edges = loop(node.at("edges"), out);
  return one;
}

Document::Block block(const Node& node) {
  return {node.at("name").text(),           node.at("family").text(),
          node.at("ni").whole(2, kLargest), node.at("nj").whole(2, kLargest),
          node.at("nk").whole(2, kLargest), {}};
}

BlockRange range(const Node& node, const Document& out) {
  BlockRange one;
  one.block = node.at("block").index(out.blocks.size());
  one.face = node.at("face").word<BlockFace>(words::kSides);
  const Document::Block& of = out.blocks[static_cast<std::size_t>(one.block)];
  const std::array<int, 3> sizes{of.ni, of.nj, of.nk};
  const auto read = [&](const char* key, std::array<int, 3>& to) {
    const Node at = node.at(key);
    at.need_size(3);
    for (std::size_t a = 0; a < 3; ++a) to[a] = at[a].whole(0, sizes[a] - 1);
    const std::size_t normal = axis_of(one.face);
    if (to[normal] != (is_max(one.face) ? sizes[normal] - 1 : 0)) {
      at[normal].refuse("has to lie on the face");
    }
  };
  read("begin", one.begin);
  read("end", one.end);
  return one;
}

Interface interface_of(const Node& node, const Document& out) {
  Interface one{range(node.at("first"), out), range(node.at("second"), out)};
  one.name = node.at("name").text();
  const Node transform = node.at("transform");
  transform.need_size(3);
  std::array<bool, 3> taken{};
  for (std::size_t a = 0; a < 3; ++a) {
    one.transform[a] = transform[a].whole(-3, 3);
    const auto to = static_cast<std::size_t>(std::abs(one.transform[a]));
    if (to == 0 || std::exchange(taken[to - 1], true)) {
      transform.refuse("has to be a permutation of 1, 2, 3, with signs");
    }
  }
  return one;
}

BoundaryFace boundary_face(const Node& node, const Document& out) {
  return {
      node.at("kind").word<BoundaryKind>(words::kBoundaries),
      node.at("name").text(),
      range(node.at("range"), out),
      {node.at("condition").word<ConditionKind>(words::kConditions), node.at("cgns_type").text()}};
}

void read_geometry(const Node& top, Document& out) {
  out.flat = top.at("flat").flag();
  out.points_world = list_of(top.at("points"), vector);
  const std::size_t points = out.points_world.size();
  out.curves = list_of(top.at("curves"), [&](const Node& one) {
    if (one.size() < 2) one.refuse("has to be a list of 2 points or more");
    return indices(one, points);
  });
  out.surfaces = list_of(top.at("surfaces"), [&](const Node& one) { return grid(one, out); });
  out.planes = list_of(top.at("planes"), plane);
  out.vertices = indices(top.at("vertices"), points);
}

void read_relations(const Node& top, Document& out) {
  const auto with_rest = [&](const auto& read) {
    return [&, read](const Node& one) { return read(one, out); };
  };
  out.edges = list_of(top.at("edges"), with_rest(edge));
  out.blocks = list_of(top.at("blocks"), block);
  out.interfaces = list_of(top.at("interfaces"), with_rest(interface_of));
  out.boundary_faces = list_of(top.at("boundary_faces"), with_rest(boundary_face));
  out.faces = list_of(top.at("faces"), with_rest(face));
  const Node blocks = top.at("blocks");
  for (std::size_t b = 0; b < out.blocks.size(); ++b) {
    const Node faces = blocks[b].at("faces");
    for (std::size_t side = 0; side < words::kSides.size(); ++side) {
      out.blocks[b].faces[side] =
          indices(faces.at(std::string(words::kSides[side]).c_str()), out.faces.size());
    }
  }
}

Json parse(const std::string& bytes, const std::string& file) {
  const auto check_depth = [&](int depth, Json::parse_event_t /*event*/, Json& /*parsed*/) {
    if (depth <= kDeepest) return true;
    throw IoError(fmt::format("{}: nests deeper than {} levels, which no topology document does",
                              file, kDeepest));
  };
  try {
    return Json::parse(bytes, check_depth);
  } catch (const Json::exception& error) {
    throw IoError(fmt::format(
        "{}: is no JSON, as a topology document is (mesh writes one with --topology): {}", file,
        error.what()));
  }
}

}  // namespace

TopologyDocument read_topology(const std::filesystem::path& file) {
  const std::string name = file.string();
  const Json json = parse(contents_of(file, "a topology document"), name);
  const Node top(json, name, "");
  const auto format = json.is_object() ? json.find("format") : json.end();
  if (format == json.end() || *format != words::kFormat) {
    throw IoError(
        fmt::format("{}: is JSON, but no topology document: its \"format\" is not \"{}\"; "
                    "mesh writes one with --topology",
                    name, words::kFormat));
  }
  top.at("version").whole(words::kVersion, words::kVersion);
  TopologyDocument out;
  read_geometry(top, out);
  read_relations(top, out);
  return out;
}

}  // namespace vdb_offset
