#include "blocks/window.h"

#include <algorithm>
#include <unordered_map>

namespace vdb_offset {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// A cell's foot without the edges that are collapsed; fewer than three columns: no face.
ColumnFace make_face(const Block& block, int i, int j) {
  const std::array<int, 4> ring = block.stack(i, j);
  ColumnFace face;
  for (std::size_t c = 0; c < 4; ++c) {
    const auto end = face.column.begin() + static_cast<std::ptrdiff_t>(face.count);
    if (std::find(face.column.begin(), end, ring[c]) == end) face.column[face.count++] = ring[c];
  }
  return face;
}

/// The free columns of one window, from one of them.
std::vector<int> flood(const ColumnGraph& graph, int from, std::vector<bool>& left) {
  std::vector<int> found{from};
  left[at(from)] = false;
  for (std::size_t n = 0; n < found.size(); ++n) {
    const std::size_t column = at(found[n]);
    for (std::size_t f = graph.first[column]; f < graph.first[column + 1]; ++f) {
      const ColumnFace& face = graph.faces[at(graph.around[f])];
      for (std::size_t c = 0; c < face.count; ++c) {
        if (!left[at(face.column[c])]) continue;
        left[at(face.column[c])] = false;
        found.push_back(face.column[c]);
      }
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

Window make_window(const ColumnGraph& graph, std::vector<int> columns) {
  Window window;
  window.free = columns.size();
  window.nodes = std::move(columns);
  std::vector<int> faces;
  for (const int column : window.nodes) {
    faces.insert(faces.end(),
                 graph.around.begin() + static_cast<std::ptrdiff_t>(graph.first[at(column)]),
                 graph.around.begin() + static_cast<std::ptrdiff_t>(graph.first[at(column) + 1]));
  }
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  std::unordered_map<int, int> slots;
  for (std::size_t s = 0; s < window.free; ++s) slots[window.nodes[s]] = static_cast<int>(s);
  for (const int f : faces) {
    ColumnFace face = graph.faces[at(f)];
    for (std::size_t c = 0; c < face.count; ++c) {
      const int node = face.column[c];
      const auto [slot, added] = slots.try_emplace(node, static_cast<int>(window.nodes.size()));
      if (added) window.nodes.push_back(node);
      face.column[c] = slot->second;
    }
    window.faces.push_back(face);
  }
  window.face_index = std::move(faces);
  return window;
}

}  // namespace

ColumnGraph::ColumnGraph(const MultiBlock& mesh) {
  for (const Block& block : mesh.blocks) {
    std::vector<int>& indices = face_of.emplace_back();
    for (int j = 0; j < block.stacks_j(); ++j) {
      for (int i = 0; i < block.stacks_i(); ++i) {
        const ColumnFace face = make_face(block, i, j);
        indices.push_back(face.count >= 3 ? static_cast<int>(faces.size()) : -1);
        if (face.count >= 3) faces.push_back(face);
      }
    }
  }
  connect(at(mesh.nodes()));
}

ColumnGraph::ColumnGraph(std::vector<ColumnFace> of_faces, std::size_t columns)
    : faces(std::move(of_faces)) {
  connect(columns);
}

/// Finds the faces around each column.
void ColumnGraph::connect(std::size_t columns) {
  first.assign(columns + 1, 0);
  for (const ColumnFace& face : faces) {
    for (std::size_t c = 0; c < face.count; ++c) ++first[at(face.column[c]) + 1];
  }
  for (std::size_t n = 1; n < first.size(); ++n) first[n] += first[n - 1];
  around.resize(first.back());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (std::size_t c = 0; c < faces[f].count; ++c) {
      around[next[at(faces[f].column[c])]++] = static_cast<int>(f);
    }
  }
}

void widen(const ColumnGraph& graph, int rings, std::vector<bool>& marked) {
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<bool> wider = marked;
    for (const ColumnFace& face : graph.faces) {
      const auto end = face.column.begin() + static_cast<std::ptrdiff_t>(face.count);
      if (std::none_of(face.column.begin(), end, [&](int c) { return marked[at(c)]; })) continue;
      for (std::size_t c = 0; c < face.count; ++c) wider[at(face.column[c])] = true;
    }
    marked.swap(wider);
  }
}

std::vector<Window> find_windows(const ColumnGraph& graph, const std::vector<bool>& marked) {
  std::vector<bool> left = marked;
  std::vector<Window> windows;
  for (std::size_t n = 0; n < left.size(); ++n) {
    if (left[n]) windows.push_back(make_window(graph, flood(graph, static_cast<int>(n), left)));
  }
  return windows;
}

}  // namespace vdb_offset
