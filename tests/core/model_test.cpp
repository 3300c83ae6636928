// Model files: good, damaged and hostile ones.
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>
#include <random>

#include "binpick/model/object_model.hpp"
#include "bracket.hpp"
#include "model/model_format.hpp"

namespace binpick {
namespace {

using Bytes = std::vector<std::uint8_t>;

const Bytes& good() {
  static const Bytes bytes = tiny_model_bytes();
  return bytes;
}

ErrorCode parsed(const Bytes& bytes) {
  const Result<ObjectModel> model = ObjectModel::parse(bytes);
  return model.ok() ? ErrorCode::kNone : model.error().code;
}

ModelHeader& header_of(Bytes& bytes) {
  return *reinterpret_cast<ModelHeader*>(bytes.data());
}

// Row of one of the file's tables.
template <class T>
T& row(Bytes& bytes, const ModelTable& table, std::size_t index) {
  return *reinterpret_cast<T*>(bytes.data() + table.offset_bytes + index * sizeof(T));
}

// The good file after `change`, with the checksum put right.
Bytes hostile(const std::function<void(ModelHeader&, Bytes&)>& change) {
  Bytes bytes = good();
  change(header_of(bytes), bytes);
  header_of(bytes).checksum = model_checksum(std::span(bytes).subspan(kChecksumFrom));
  return bytes;
}

ErrorCode parsed_after(const std::function<void(ModelHeader&, Bytes&)>& change) {
  return parsed(hostile(change));
}

TEST(Model, IsReadAsItWasWritten) {
  const Result<ObjectModel> result = ObjectModel::parse(good());
  ASSERT_TRUE(result.ok()) << result.error().where;
  const ObjectModel& model = result.value();
  EXPECT_EQ(0xB0A7u, model.info().source_hash);
  EXPECT_EQ(2, model.depth_count());
  EXPECT_EQ(good().size(), model.bytes_total());
  EXPECT_NEAR(65, model.info().bounds_max_mm[0] - model.info().bounds_min_mm[0], 1e-6);
  EXPECT_EQ(model.depth(0).roll_count * 2, model.depth(1).roll_count);
  EXPECT_EQ(2, model.depth(1).distance_count);
  for (int d = 0; d < 2; ++d) {
    for (const TemplateRange& t : model.depth(d).templates) EXPECT_GT(model.features(t).size(), 0u);
  }
  for (const Viewpoint& v : model.depth(1).viewpoints) {
    EXPECT_GT(model.surface(v).count, 50);
    EXPECT_GT(model.contour(v).count, 20);
    EXPECT_GT(v.outline_count, 0u);
  }
}

TEST(Model, ReadsSamplesAsPaddedArrays) {
  const Result<ObjectModel> result = ObjectModel::parse(good());
  ASSERT_TRUE(result.ok());
  const ObjectModel& model = result.value();
  for (const Viewpoint& v : model.depth(1).viewpoints) {
    for (const SampleArrays& s : {model.surface(v), model.contour(v)}) {
      EXPECT_LE(s.first(3).count, s.count);
      const auto padded = static_cast<int>(padded_samples(static_cast<std::uint64_t>(s.count)));
      const float* const arrays[] = {s.x, s.y, s.z, s.dx, s.dy, s.dz};
      for (int i = 0; i < s.count; ++i) {
        EXPECT_NEAR(1, Eigen::Vector3f(s.dx[i], s.dy[i], s.dz[i]).norm(), 1e-5) << i;
        EXPECT_LT(Eigen::Vector3f(s.x[i], s.y[i], s.z[i]).norm(), model.info().diameter_mm) << i;
      }
      for (const float* array : arrays) {
        for (int i = s.count; i < padded; ++i) EXPECT_EQ(0, array[i]);
      }
    }
  }
}

TEST(Model, ListsWhereItsLeavesLook) {
  const Result<ObjectModel> result = ObjectModel::parse(good());
  ASSERT_TRUE(result.ok());
  const std::span<const Viewpoint> leaves = result.value().depth(1).viewpoints;
  const SampleArrays d = result.value().viewing_directions();
  ASSERT_EQ(leaves.size(), static_cast<std::size_t>(d.count));
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    EXPECT_EQ(leaves[i].R_view_obj[6], d.x[i]);
    EXPECT_EQ(leaves[i].R_view_obj[7], d.y[i]);
    EXPECT_EQ(leaves[i].R_view_obj[8], d.z[i]);
  }
}

TEST(Model, DistancesAndRollsStandInTheMiddleOfTheirIntervals) {
  const Result<ObjectModel> result = ObjectModel::parse(good());
  ASSERT_TRUE(result.ok());
  const ObjectModel& model = result.value();  // 460 to 600 mm in two steps of the same ratio
  const double middle_mm = std::sqrt(460.0 * 600);
  EXPECT_NEAR(middle_mm, model.distance_mm(0, 0), 1e-9);
  EXPECT_NEAR(std::sqrt(460 * middle_mm), model.distance_mm(1, 0), 1e-9);
  EXPECT_NEAR(std::sqrt(middle_mm * 600), model.distance_mm(1, 1), 1e-9);
  EXPECT_NEAR(140, model.distance_interval_mm(0, 0), 1e-9);
  EXPECT_NEAR(600 - middle_mm, model.distance_interval_mm(1, 1), 1e-9);
  EXPECT_NEAR(model.roll_rad(0, 1), (model.roll_rad(1, 2) + model.roll_rad(1, 3)) / 2, 1e-12);
  const Mat3 R = model.rotation(1, 3, 5);
  EXPECT_LT((R * R.transpose() - Mat3::Identity()).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(Model, TruncatedAnywhereIsRefused) {
  std::mt19937 random(1);
  std::vector<std::size_t> lengths = {
      0, 1, 7, 8, 9, 16, 31, sizeof(ModelHeader) - 1, sizeof(ModelHeader), good().size() - 1};
  for (int i = 0; i < 200; ++i) lengths.push_back(random() % good().size());
  for (const std::size_t length : lengths) {
    const Bytes cut(good().begin(), good().begin() + static_cast<std::ptrdiff_t>(length));
    EXPECT_EQ(ErrorCode::kModelTruncated, parsed(cut)) << length;
  }
  Bytes longer = good();
  longer.push_back(0);
  EXPECT_EQ(ErrorCode::kModelTruncated, parsed(longer));
}

TEST(Model, AnySingleFlippedBitIsRefused) {
  constexpr std::size_t kFlips = 2000;
  std::mt19937 random(2);
  Bytes bytes = good();
  for (std::size_t i = 0; i < kFlips; ++i) {
    // All of the header's start, then anywhere.
    const std::size_t bit = i < 64 * 8 ? i : random() % (8 * bytes.size());
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1u << bit % 8));
    EXPECT_NE(ErrorCode::kNone, parsed(bytes)) << "bit " << bit;
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1u << bit % 8));
  }
  EXPECT_EQ(ErrorCode::kNone, parsed(bytes));
}

TEST(Model, FlippedContentIsNamedAsDamage) {
  std::mt19937 random(3);
  Bytes bytes = good();
  for (int i = 0; i < 200; ++i) {
    const std::size_t at = kChecksumFrom + random() % (bytes.size() - kChecksumFrom);
    bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ 0x10);
    EXPECT_EQ(ErrorCode::kModelChecksum, parsed(bytes)) << at;
    bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ 0x10);
  }
}

TEST(Model, ForeignFilesAreRefused) {
  Bytes text(5000, 'x');
  EXPECT_EQ(ErrorCode::kModelForeign, parsed(text));
  EXPECT_EQ(ErrorCode::kModelForeign, parsed(Bytes(8, 0)));
  EXPECT_EQ(ErrorCode::kModelTruncated, parsed({}));
}

TEST(Model, AnotherVersionIsRefused) {
  for (const std::uint32_t version : {0u, kModelVersion - 1, kModelVersion + 1, 0xFFFFFFFFu}) {
    EXPECT_EQ(ErrorCode::kModelVersion,
              parsed_after([&](ModelHeader& h, Bytes&) { h.version = version; }));
  }
  EXPECT_EQ(ErrorCode::kModelVersion,
            parsed_after([](ModelHeader& h, Bytes&) { h.header_bytes += 8; }));
}

TEST(Model, HostileTablesAreRefused) {
  constexpr std::uint64_t kHuge[] = {0xFFFFFFFFFFFFFFC0ull, 1ull << 63, 1ull << 40};
  for (const std::uint64_t huge : kHuge) {
    const std::function<ModelTable&(ModelHeader&)> tables[] = {
        [](ModelHeader& h) -> ModelTable& { return h.features; },
        [](ModelHeader& h) -> ModelTable& { return h.samples; },
        [](ModelHeader& h) -> ModelTable& { return h.viewing_directions; },
        [](ModelHeader& h) -> ModelTable& { return h.symmetry_turns; },
        [](ModelHeader& h) -> ModelTable& { return h.symmetry_axes; },
        [](ModelHeader& h) -> ModelTable& { return h.depths[0].viewpoints; },
        [](ModelHeader& h) -> ModelTable& { return h.depths[0].templates; },
        [](ModelHeader& h) -> ModelTable& { return h.depths[1].viewpoints; },
        [](ModelHeader& h) -> ModelTable& { return h.depths[1].templates; }};
    for (const auto& table : tables) {
      const auto offset = [&](ModelHeader& h, Bytes&) { table(h).offset_bytes = huge; };
      const auto count = [&](ModelHeader& h, Bytes&) { table(h).count = huge; };
      const auto shifted = [&](ModelHeader& h, Bytes&) { table(h).offset_bytes += 8; };
      const auto longer = [&](ModelHeader& h, Bytes& b) { table(h).count += b.size(); };
      EXPECT_EQ(ErrorCode::kModelInconsistent, parsed_after(offset));
      EXPECT_EQ(ErrorCode::kModelInconsistent, parsed_after(count));
      EXPECT_EQ(ErrorCode::kModelInconsistent, parsed_after(shifted));
      EXPECT_EQ(ErrorCode::kModelInconsistent, parsed_after(longer));
    }
  }
}

TEST(Model, HostileTreesAreRefused) {
  using Change = std::function<void(ModelHeader&, Bytes&)>;
  const auto viewpoint = [](int depth, auto&& change) -> Change {
    return
        [=](ModelHeader& h, Bytes& b) { change(row<Viewpoint>(b, h.depths[depth].viewpoints, 1)); };
  };
  const Change changes[] = {
      [](ModelHeader& h, Bytes&) { h.depths[0].viewpoints.count = 0; },
      [](ModelHeader& h, Bytes&) { h.depths[1].viewpoints.count -= 1; },
      [](ModelHeader& h, Bytes&) { h.depths[1].templates.count -= 1; },
      [](ModelHeader& h, Bytes&) { h.depths[1].roll_count = -1; },
      [](ModelHeader& h, Bytes&) { h.depths[1].roll_count = 0; },
      [](ModelHeader& h, Bytes&) { h.depths[1].roll_count += 1; },
      [](ModelHeader& h, Bytes&) { h.depths[1].distance_count = 0; },
      [](ModelHeader& h, Bytes&) { h.depths[1].distance_count = 0x7FFFFFFF; },
      [](ModelHeader& h, Bytes&) { h.depths[1].distance_count = 5; },
      // More distances than a search has room for.
      [](ModelHeader& h, Bytes&) {
        h.depths[0].distance_count = 50;
        h.depths[1].distance_count = 100;
      },
      viewpoint(0, [](Viewpoint& v) { v.child_first = -1; }),
      viewpoint(0, [](Viewpoint& v) { v.child_first = 0x7FFFFFFF; }),
      viewpoint(0, [](Viewpoint& v) { v.child_count = -1; }),
      viewpoint(0, [](Viewpoint& v) { v.child_count = 10000; }),
      viewpoint(1, [](Viewpoint& v) { v.child_count = 1; }),  // leaves have none
      viewpoint(1, [](Viewpoint& v) { v.surface_first = 0xFFFFFFFF; }),
      viewpoint(1, [](Viewpoint& v) { v.surface_first = 0xFFFFFFF8; }),
      viewpoint(1, [](Viewpoint& v) { v.surface_first += 1; }),  // arrays begin at whole steps
      viewpoint(1, [](Viewpoint& v) { v.surface_count = 0xFFFFFFFF; }),
      // More than the detector has room for, though the table holds as many.
      viewpoint(1, [](Viewpoint& v) { v.surface_first = 0, v.surface_count = 321; }),
      viewpoint(1, [](Viewpoint& v) { v.contour_first = 0xFFFFFFF0; }),
      viewpoint(1, [](Viewpoint& v) { v.contour_first += 4; }),
      viewpoint(1, [](Viewpoint& v) { v.contour_count = 0x10000000; }),
      viewpoint(1, [](Viewpoint& v) { v.contour_first = 0, v.contour_count = 193; }),
      viewpoint(1, [](Viewpoint& v) { v.outline_count = v.contour_count + 1; }),
      viewpoint(1, [](Viewpoint& v) { v.outline_count = 0xFFFFFFFF; }),
      // The last arrays reach beyond the table.
      [](ModelHeader& h, Bytes&) { h.samples.count -= 8; },
      [](ModelHeader& h, Bytes&) { h.viewing_directions.count -= 8; },
      [](ModelHeader& h, Bytes&) { h.viewing_directions.count = 0; },
      viewpoint(1,
                [](Viewpoint& v) { v.R_view_obj[4] = std::numeric_limits<float>::quiet_NaN(); })};
  int index = 0;
  for (const Change& change : changes) {
    EXPECT_EQ(ErrorCode::kModelInconsistent, parsed_after(change)) << "change " << index;
    ++index;
  }
}

TEST(Model, HostileTemplatesAreRefused) {
  const auto refused = [](auto&& change) {
    return parsed_after([&](ModelHeader& h, Bytes& b) {
             TemplateRange& t = row<TemplateRange>(b, h.depths[1].templates, 2);
             change(t, row<Feature>(b, h.features, t.first));
           }) == ErrorCode::kModelInconsistent;
  };
  EXPECT_TRUE(refused([](TemplateRange& t, Feature&) { t.first = 0xFFFFFFFF; }));
  EXPECT_TRUE(refused([](TemplateRange& t, Feature&) { t.count = 0xFFFF; }));
  EXPECT_TRUE(refused([](TemplateRange& t, Feature&) { t.count = 256; }));
  EXPECT_TRUE(refused([](TemplateRange& t, Feature&) { ++t.gradient_weight_sum; }));
  EXPECT_TRUE(refused([](TemplateRange& t, Feature&) { --t.normal_weight_sum; }));
  EXPECT_TRUE(refused([](TemplateRange& t, Feature& f) {
    t.gradient_weight_sum =
        static_cast<std::uint16_t>(t.gradient_weight_sum + 32 - f.gradient_weight);
    f.gradient_weight = 32;
  }));
}

TEST(Model, HostileParametersAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](auto&& change) {
    return parsed_after([&](ModelHeader& h, Bytes&) { change(h.info); }) ==
           ErrorCode::kModelInconsistent;
  };
  EXPECT_TRUE(refused([](ModelInfo& i) { i.camera.fx = 0; }));
  EXPECT_TRUE(refused([&](ModelInfo& i) { i.camera.cy = nan; }));
  EXPECT_TRUE(refused([&](ModelInfo& i) { i.distance_min_mm = nan; }));
  EXPECT_TRUE(refused([](ModelInfo& i) { i.distance_min_mm = -1; }));
  EXPECT_TRUE(refused([](ModelInfo& i) { i.distance_max_mm = i.distance_min_mm / 2; }));
  EXPECT_TRUE(refused([](ModelInfo& i) { i.reference_distance_mm = 0; }));
  EXPECT_TRUE(refused([](ModelInfo& i) { i.diameter_mm = -3; }));
  EXPECT_TRUE(refused([&](ModelInfo& i) { i.bounds_min_mm[1] = nan; }));
  EXPECT_TRUE(refused([](ModelInfo& i) { i.depth_count = 0; }));
  EXPECT_TRUE(refused([](ModelInfo& i) { i.depth_count = 5; }));
  EXPECT_TRUE(refused([](ModelInfo& i) { i.scan_depth = -1; }));
  EXPECT_TRUE(refused([](ModelInfo& i) { i.scan_depth = i.depth_count; }));
  EXPECT_TRUE(refused([](ModelInfo& i) { i.base_level = 8; }));
  EXPECT_TRUE(refused([](ModelInfo& i) { i.base_level = -1; }));
  EXPECT_TRUE(refused([](ModelInfo& i) { i.normal_codebook = static_cast<NormalCodebook>(7); }));
}

TEST(Model, HostileSamplesAreRefused) {
  const float inf = std::numeric_limits<float>::infinity();
  EXPECT_EQ(ErrorCode::kModelInconsistent,
            parsed_after([&](ModelHeader& h, Bytes& b) { row<float>(b, h.samples, 3) = inf; }));
  EXPECT_EQ(ErrorCode::kModelInconsistent, parsed_after([&](ModelHeader& h, Bytes& b) {
              row<float>(b, h.samples, h.samples.count - 1) = inf;
            }));
  EXPECT_EQ(ErrorCode::kModelInconsistent, parsed_after([&](ModelHeader& h, Bytes& b) {
              row<float>(b, h.viewing_directions, 2) = -inf;
            }));
}

// Whatever is written over the file, it is refused or it can be used; run under the sanitizers too.
TEST(Model, RandomWordsWithARepairedChecksumNeverCrash) {
  std::mt19937 random(4);
  int accepted = 0;
  for (int i = 0; i < 1000; ++i) {
    const Bytes bytes = hostile([&](ModelHeader& h, Bytes& b) {
      const std::size_t limit = i % 2 == 0 ? sizeof(ModelHeader) : b.size();
      const std::size_t at = kChecksumFrom + random() % (limit - kChecksumFrom - 4);
      const std::uint32_t word = i % 3 == 0 ? 0xFFFFFFFFu : static_cast<std::uint32_t>(random());
      std::memcpy(b.data() + at, &word, sizeof(word));
      (void)h;
    });
    const Result<ObjectModel> result = ObjectModel::parse(bytes);
    if (!result.ok()) continue;
    ++accepted;
    const ObjectModel& model = result.value();
    std::size_t touched = 0;
    for (int d = 0; d < model.depth_count(); ++d) {
      for (const TemplateRange& t : model.depth(d).templates) {
        for (const Feature& f : model.features(t)) touched += f.gradient_bits;
      }
      for (const Viewpoint& v : model.depth(d).viewpoints) {
        for (const SampleArrays& s : {model.surface(v), model.contour(v)}) {
          for (int k = 0; k < s.count; ++k) touched += s.x[k] < s.dz[k];
        }
      }
    }
    EXPECT_GT(touched, 0u);
  }
  EXPECT_GT(accepted, 0);
}

}  // namespace
}  // namespace binpick
