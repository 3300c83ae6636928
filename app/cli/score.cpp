// binpick score: scores a results file against a data set's truth.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.hpp"
#include "cli/id_list.hpp"
#include "eval/part_library.hpp"
#include "eval/score_json.hpp"
#include "eval/table.hpp"
#include "replace_file.hpp"

namespace binpick::app {
namespace {

struct Options {
  std::string dataset, results, split = "test", sensor, scenes, objects, json;
  ScoreOptions score;
  double threshold = 0;
};

std::set<int> objects_of(const TruthByFrame& truth) {
  std::set<int> objects;
  for (const auto& [id, instances] : truth) {
    for (const ScoredInstance& i : instances) objects.insert(i.truth.obj_id);
  }
  return objects;
}

void run(const Options& options) {
  if (!options.json.empty() && options.json != "-") check_replaceable(options.json);
  const drivers::BopDataset dataset(options.dataset, options.split, options.sensor);
  std::set<int> scenes = parse_id_list("--scenes", options.scenes);
  if (scenes.empty()) scenes.insert(dataset.scene_ids().begin(), dataset.scene_ids().end());
  const TruthByFrame truth = load_score_truth(dataset, scenes);
  if (truth.empty())
    throw drivers::DatasetError(options.dataset + ": these scenes have no scene_gt.json");

  ScoreOptions score_options = options.score;
  score_options.objects = parse_id_list("--objects", options.objects);
  const std::set<int> needed =
      score_options.objects.empty() ? objects_of(truth) : score_options.objects;
  const std::vector<ResultRow> rows = read_bop_results(options.results);
  const ScoreReport report = score_results(geometry_of(load_parts(dataset, needed)), truth, rows,
                                           times_of_frames(rows), score_options);
  const std::string json = score_to_json(report).dump(1) + "\n";
  if (options.json == "-") {
    std::fputs(json.c_str(), stdout);
    return;
  }
  std::fputs(score_table(report).c_str(), stdout);
  if (options.json.empty()) return;
  replace_file(options.json, {reinterpret_cast<const std::uint8_t*>(json.data()), json.size()});
}

}  // namespace

void add_score_command(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("score", "Score a BOP results file against the truth of a data set");
  command->add_option("dataset", options->dataset, "Folder in BOP layout")->required();
  command->add_option("results", options->results, "CSV with scene_id,im_id,obj_id,score,R,t,time")
      ->required();
  command->add_option("--split", options->split, "Folder of the scenes")->capture_default_str();
  command->add_option("--sensor", options->sensor,
                      "Of a data set with several sensors: the one whose frames were searched");
  command->add_option("--scenes", options->scenes, "Scenes, such as 1,2,5-7; all when left out");
  command->add_option("--objects", options->objects, "Objects, such as 1,3; all when left out");
  command->add_option("--json", options->json,
                      "Write the scores as JSON; - writes them to the terminal alone");
  command->add_option("--mm", options->score.limits.mm, "Limit of x, y and z")
      ->capture_default_str();
  command->add_option("--deg", options->score.limits.deg, "Limit of the rotations")
      ->capture_default_str();
  command
      ->add_option("--min-visib", options->score.visible_min,
                   "Visible share of what has to be found")
      ->capture_default_str();
  CLI::Option* threshold =
      command->add_option("--threshold", options->threshold, "Report F1 at this score too");
  command->callback([options, threshold, &exit_status] {
    if (threshold->count() > 0) options->score.fixed_threshold = options->threshold;
    run(*options);
    exit_status = 0;
  });
}

}  // namespace binpick::app
