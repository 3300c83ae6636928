#include <memory>

#include "bench/kernels/kernel_bench.hpp"
#include "kernels/kernel_inputs.hpp"

namespace binpick::simd {
namespace {

// As the trainer's defaults make them: so many features of a template, the first of which have a
// gradient.
constexpr int kFeatures = 96, kWithGradient = 56;

// A region of 704 x 416 px at one level of its pyramid, and a template that reaches so far from its
// middle.
struct LevelInputs {
  LevelInputs(int level, int reach)
      : width(704 >> level),
        height(416 >> level),
        features(random_features(kFeatures, reach, random)) {
    for (std::size_t i = kWithGradient; i < features.size(); ++i)
      features[i].gradient_bits = features[i].gradient_weight = 0;
    rows = placed(features, maps.plain().steps());
    blocks = placed(features, maps.rearranged().steps());
  }
  static PlacedTemplate placed_template(const std::vector<PlacedFeature>& features) {
    return {features.data(), kFeatures, kWithGradient, ScoreScale(1000, 1000)};
  }

  int width, height;
  std::mt19937 random{7};
  KernelMaps maps{width, height, 64, 128, random};
  std::vector<Feature> features;
  std::vector<PlacedFeature> rows, blocks;
};

void add_scan(const KernelTable& table) {
  const auto inputs = std::make_shared<LevelInputs>(3, 10);
  const int cells = inputs->width / 2;
  // Nothing improves, as nearly always in a scan.
  const std::vector<std::uint16_t> known(static_cast<std::size_t>(cells + kReadAhead), UINT16_MAX);
  std::vector<CellScore> better(static_cast<std::size_t>(cells));
  const Traffic traffic{2.0 * inputs->width * (kFeatures + kWithGradient),
                        2.0 * inputs->width * inputs->height};
  add_benchmark(std::string("scan_cells/") + table.name, traffic, [=](int i) mutable {
    const PlainMaps maps = inputs->maps.plain();
    table.search.scan_cells(maps, i % (inputs->height / 2) * 2 * maps.stride, cells,
                            LevelInputs::placed_template(inputs->rows), known.data(),
                            better.data());
  });
}

// One template at the blocks of `parents` candidates at once; then the next of their children.
template <class Map, class Match>
void add_blocks(const std::string& name, int parents, const LevelInputs& level, const Map& map,
                int map_bytes_per_pixel, Match match) {
  constexpr int kChildren = 16;
  const Traffic traffic{static_cast<double>(parents) * kFeatures * kBlockBytes,
                        static_cast<double>(map_bytes_per_pixel) * level.width * level.height};
  add_benchmark(name, traffic, [=, &level](int i) {
    std::ptrdiff_t places[8];
    BlockScores scores[8];
    for (int p = 0; p < parents; ++p) {
      const int at = i / kChildren + 7 * p;
      places[p] = at * 37 % (level.width / 2 - 2) * map.steps().x +
                  at * 19 % (level.height / 2 - 2) * map.steps().y;
    }
    match(places, scores);
  });
}

void add_descent(const KernelTable& table) {
  const auto inputs = std::make_shared<LevelInputs>(2, 20);
  const MapSteps steps = inputs->maps.rearranged().steps();
  std::vector<PlacedFeature> out(kFeatures);
  constexpr double kBytes = kFeatures * (sizeof(Feature) + sizeof(PlacedFeature));
  add_benchmark(std::string("place_features/") + table.name, {kBytes, kBytes}, [=](int) mutable {
    table.search.place_features(inputs->features.data(), kFeatures, 256, steps, out.data());
  });
  for (const int parents : {1, 4, 8}) {
    const std::string end = "_" + std::to_string(parents) + "/" + table.name;
    add_blocks("match_blocks_plain" + end, parents, *inputs, inputs->maps.plain(), 2,
               [=](const std::ptrdiff_t* places, BlockScores* scores) {
                 table.search.match_blocks_plain(inputs->maps.plain(), places, parents,
                                                 LevelInputs::placed_template(inputs->rows),
                                                 scores);
               });
    add_blocks("match_blocks_rearranged" + end, parents, *inputs, inputs->maps.rearranged(), 8,
               [=](const std::ptrdiff_t* places, BlockScores* scores) {
                 table.search.match_blocks_rearranged(inputs->maps.rearranged(), places, parents,
                                                      LevelInputs::placed_template(inputs->blocks),
                                                      scores);
               });
  }
}

}  // namespace

void add_search_kernels(const KernelTable& table) {
  add_scan(table);
  add_descent(table);
}

}  // namespace binpick::simd
