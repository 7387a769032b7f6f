#include <vdb_offset/io/vtk.h>
#include <vdb_offset/pipeline.h>
#include <vdb_offset/surface/example.h>

int main() {
  vdb_offset::PipelineOptions options;
  options.distance_world = 0.25;
  options.spacing.layers = 16;
  options.spacing.first_cell_world = 1e-3;
  const auto result = vdb_offset::make_mesh(vdb_offset::make_example("cube"), options);
  vdb_offset::write_vtm("cube.vtm", result.mesh, result.quality);
  return result.quality.report.nonpositive_cells == 0 ? 0 : 1;
}
