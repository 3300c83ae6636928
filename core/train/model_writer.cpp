#include "train/model_writer.hpp"

#include <algorithm>
#include <cstring>

#include "binpick/train/trainer.hpp"
#include "model/model_format.hpp"

namespace binpick::train {
namespace {

template <class T>
ModelTable append_table(std::vector<std::uint8_t>& bytes, const std::vector<T>& rows) {
  bytes.resize((bytes.size() + kModelAlignment - 1) / kModelAlignment * kModelAlignment, 0);
  const ModelTable table{bytes.size(), rows.size()};
  bytes.resize(bytes.size() + rows.size() * sizeof(T));
  if (!rows.empty())
    std::memcpy(bytes.data() + table.offset_bytes, rows.data(), rows.size() * sizeof(T));
  return table;
}

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

// Rows as arrays of their components, each padded.
void append_arrays(std::vector<float>& to, const std::vector<PointSample>& rows) {
  const std::size_t padding = padded_samples(rows.size()) - rows.size();
  for (float const(PointSample::*vector)[3] :
       {&PointSample::position_mm, &PointSample::direction}) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (const PointSample& row : rows) to.push_back((row.*vector)[k]);
      to.insert(to.end(), padding, 0.0f);
    }
  }
}

// The third rows of the viewpoints' rotations.
std::vector<float> viewing_directions(const TreeLayer& leaves) {
  const std::size_t count = leaves.viewpoints.size(), row = padded_samples(count);
  std::vector<float> out(3 * row, 0.0f);
  for (std::size_t v = 0; v < count; ++v) {
    for (std::size_t k = 0; k < 3; ++k) {
      out[k * row + v] =
          static_cast<float>(leaves.viewpoints[v].R_view_obj(2, static_cast<Eigen::Index>(k)));
    }
  }
  return out;
}

// The header in front of the tables, with the checksum of all.
void seal(ModelHeader& header, std::vector<std::uint8_t>& bytes) {
  std::memcpy(bytes.data(), &header, sizeof(header));
  header.checksum = model_checksum(std::span(bytes).subspan(kChecksumFrom));
  std::memcpy(bytes.data(), &header, sizeof(header));
}

// The near rows of a table stand behind the exact ones.
template <class Row>
void mark_near(const ModelTable& table, const std::vector<bool>& indistinguishable,
               std::vector<std::uint8_t>& model) {
  BINPICK_ASSERT(indistinguishable.size() <= table.count);
  std::uint8_t* at =
      model.data() + table.offset_bytes + (table.count - indistinguishable.size()) * sizeof(Row);
  for (const bool is : indistinguishable) {
    Row row;
    std::memcpy(&row, at, sizeof(row));
    BINPICK_ASSERT(row.kind != SymmetryKind::kExact);
    row.kind = is ? SymmetryKind::kIndistinguishable : SymmetryKind::kNear;
    std::memcpy(at, &row, sizeof(row));
    at += sizeof(row);
  }
}

}  // namespace

std::vector<std::uint8_t> write_model(const ModelInfo& info, const PoseTree& tree,
                                      const TemplateSet& templates,
                                      const std::vector<ViewSamples>& views,
                                      const FoundSymmetry& symmetry) {
  ModelHeader header;
  std::memset(static_cast<void*>(&header), 0,
              sizeof(header));  // padding too: the same part gives the same bytes
  std::memcpy(header.magic, kModelMagic, sizeof(kModelMagic));
  header.version = kModelVersion;
  header.header_bytes = sizeof(ModelHeader);
  std::memcpy(static_cast<void*>(&header.info), &info, sizeof(info));
  header.trials = ModelTrials{};
  std::vector<std::uint8_t> bytes(sizeof(ModelHeader), 0);

  std::vector<Feature> features;
  std::vector<float> samples;
  const int depths = static_cast<int>(tree.depths.size());
  for (int d = 0; d < depths; ++d) {
    const TreeLayer& layer = tree.depths[d];
    std::vector<Viewpoint> viewpoints;
    for (std::size_t v = 0; v < layer.viewpoints.size(); ++v) {
      const TreeViewpoint& from = layer.viewpoints[v];
      Viewpoint to{};
      for (int i = 0; i < 9; ++i)
        to.R_view_obj[i] = static_cast<float>(from.R_view_obj(i / 3, i % 3));
      to.parent = from.parent;
      to.child_first = from.child_first;
      to.child_count = from.child_count;
      if (d == depths - 1) {
        to.surface_first = static_cast<std::uint32_t>(samples.size());
        to.surface_count = static_cast<std::uint32_t>(views[v].surface.size());
        append_arrays(samples, views[v].surface);
        to.contour_first = static_cast<std::uint32_t>(samples.size());
        to.contour_count = static_cast<std::uint32_t>(views[v].contour.size());
        append_arrays(samples, views[v].contour);
        to.outline_count = static_cast<std::uint32_t>(views[v].outline_count);
        to.sample_area_mm2 = static_cast<float>(views[v].sample_area_mm2);
      }
      viewpoints.push_back(to);
    }
    std::vector<TemplateRange> ranges;
    for (const std::vector<Feature>& t : templates.depths[d]) {
      TemplateRange range{};
      range.first = static_cast<std::uint32_t>(features.size());
      range.count = static_cast<std::uint16_t>(t.size());
      for (const Feature& f : t) {
        range.gradient_weight_sum =
            static_cast<std::uint16_t>(range.gradient_weight_sum + f.gradient_weight);
        range.normal_weight_sum =
            static_cast<std::uint16_t>(range.normal_weight_sum + f.normal_weight);
      }
      append(features, t);
      ranges.push_back(range);
    }
    header.depths[d].viewpoints = append_table(bytes, viewpoints);
    header.depths[d].templates = append_table(bytes, ranges);
    header.depths[d].roll_count = layer.roll_count;
    header.depths[d].distance_count = layer.distance_count;
  }
  header.features = append_table(bytes, features);
  header.samples = append_table(bytes, samples);
  header.viewing_directions = append_table(bytes, viewing_directions(tree.leaves()));
  header.symmetry_turns = append_table(bytes, symmetry.turns);
  header.symmetry_axes = append_table(bytes, symmetry.axes);
  header.file_bytes = bytes.size();
  seal(header, bytes);
  return bytes;
}

bool NearSymmetries::any() const {
  const auto one_of = [](const std::vector<bool>& list) {
    return std::find(list.begin(), list.end(), true) != list.end();
  };
  return one_of(turns) || one_of(axes);
}

void set_indistinguishable(std::vector<std::uint8_t>& model, const NearSymmetries& which) {
  ModelHeader header;
  std::memcpy(static_cast<void*>(&header), model.data(), sizeof(header));
  mark_near<SymmetryTurn>(header.symmetry_turns, which.turns, model);
  mark_near<SymmetryAxis>(header.symmetry_axes, which.axes, model);
  seal(header, model);
}

void set_trials(std::vector<std::uint8_t>& model, const ModelTrials& trials) {
  ModelHeader header;
  std::memcpy(static_cast<void*>(&header), model.data(), sizeof(header));
  header.trials = trials;
  seal(header, model);
}

}  // namespace binpick::train
