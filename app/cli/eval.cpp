// binpick eval: trains what is needed, searches every frame of a data set, scores what was found.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/arguments.hpp"
#include "cli/commands.hpp"
#include "cli/id_list.hpp"
#include "cli/number_between.hpp"
#include "cli/progress.hpp"
#include "cli/training_options.hpp"
#include "eval/eval_json.hpp"
#include "eval/evaluation.hpp"
#include "eval/report_html.hpp"
#include "eval/report_pictures.hpp"
#include "eval/table.hpp"
#include "replace_file.hpp"
#include "thread_pool.hpp"

namespace binpick::app {
namespace {

constexpr std::size_t kPicturesMax = 12;

struct Options {
  std::string dataset, csv, evidence, split = "test", scenes, objects, model_cache, json, report;
  std::string layout = "rearranged", isa = "best";
  int threads = default_thread_count();
  double threshold = DetectRequest{}.min_score;
  EvalSettings settings;
  train::TrainOptions train;
  TrialPlan trials{.test_piles = 0};
};

void write_text(const std::string& path, const std::string& text) {
  replace_file(path, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

// Notes and bars share the error stream: a note ends the bar, and the next progress begins another.
EvalTalk terminal_talk() {
  auto bar = std::make_shared<StepProgress>();
  EvalTalk talk;
  talk.note = [bar](const std::string& text) {
    bar->finish();
    std::fprintf(stderr, "binpick: %s\n", text.c_str());
  };
  talk.progress = [bar](const std::string& step, double share) { bar->update(step, share); };
  return talk;
}

void take_settings(Options& options) {
  DetectorParams& params = options.settings.params;
  params.layout = options.layout == "plain" ? MapLayout::kPlain : MapLayout::kRearranged;
  params.isa = parse_isa("--isa", options.isa);
}

std::vector<std::pair<std::string, std::string>> facts_of(const Options& o) {
  char score[32];
  std::snprintf(score, sizeof score, "%g", o.settings.min_score);
  return {{"data set", o.dataset},
          {"split", o.split},
          {"scenes", o.scenes.empty() ? "all" : o.scenes},
          {"objects", o.objects.empty() ? "all" : o.objects},
          {"threads", std::to_string(o.threads)},
          {"layout", o.layout},
          {"instruction set", o.isa},
          {"results at most", std::to_string(o.settings.max_results)},
          {"score at least", score}};
}

// Searches all frames; camera groups one after the other, each with its own models and detector.
std::vector<ModelOrigin> search(const Options& options, const drivers::BopDataset& dataset,
                                const EvalPlan& plan, const PartLibrary& parts,
                                const EvalTalk& talk, EvalRun& run) {
  ThreadPool pool(options.threads);
  const ModelCache cache(options.model_cache);
  BopResultsWriter writer(options.csv);
  std::optional<EvidenceWriter> evidence;
  if (!options.evidence.empty()) evidence.emplace(options.evidence);
  const EvalOutput output{&writer, evidence ? &*evidence : nullptr};
  std::vector<ModelOrigin> origins;
  for (const CameraGroup& group : plan.cameras) {
    const ModelSet models =
        make_model_set({dataset, plan, group, parts, cache, options.train, options.trials}, pool,
                       talk, run.faults);
    origins.insert(origins.end(), models.origins().begin(), models.origins().end());
    run_group(dataset, plan, group, models, options.settings, pool, talk, output, run);
  }
  writer.close();
  if (evidence) evidence->close();
  return origins;
}

ScoreReport score_run(const Options& options, const EvalPlan& plan, const PartLibrary& parts,
                      const EvalRun& run) {
  ScoreOptions score_options;
  score_options.fixed_threshold = options.threshold;
  score_options.objects = plan.objects();
  return score_results(geometry_of(parts), plan.truth, run.rows, run.times_s(), score_options);
}

void write_report(const Options& options, const drivers::BopDataset& dataset, const EvalPlan& plan,
                  const PartLibrary& parts, ReportContent content,
                  const std::vector<ResultRow>& rows) {
  std::filesystem::create_directories(options.report);
  content.pictures = worst_pictures(dataset, plan, parts, content.score, rows, kPicturesMax);
  write_text((std::filesystem::path(options.report) / "report.html").string(),
             report_html(content));
}

int run(const Options& options) {
  const EvalTalk talk = terminal_talk();
  const drivers::BopDataset dataset(options.dataset, options.split);
  const EvalPlan plan = make_eval_plan(dataset, {parse_id_list("--scenes", options.scenes),
                                                 parse_id_list("--objects", options.objects)});
  EvalRun run;
  run.faults = plan.faults;
  for (const std::string& fault : plan.faults) talk.note(fault);
  const PartLibrary parts = load_parts(dataset, plan.objects());
  const std::vector<ModelOrigin> models = search(options, dataset, plan, parts, talk, run);

  const ScoreReport score = score_run(options, plan, parts, run);
  const std::vector<RunLine> lines = summarize_parts(run, score);
  if (plan.truth.empty()) {
    std::printf("The data set has no truth for these frames: there are times, but no scores.\n");
  } else {
    std::printf("%s\n", score_table(score).c_str());
  }
  std::printf("%s\n%s", stage_table(lines).c_str(), level_table(lines).c_str());
  const auto facts = facts_of(options);
  if (!options.json.empty())
    write_text(options.json, eval_to_json(score, run, models, facts).dump(1) + "\n");
  if (!options.report.empty()) {
    const std::string title =
        "binpick on " + std::filesystem::path(options.dataset).filename().string();
    write_report(options, dataset, plan, parts,
                 {title, facts, score, lines, models, run.faults, {}}, run.rows);
  }
  if (!run.faults.empty()) talk.note(std::to_string(run.faults.size()) + " fault(s), named above");
  return run.faults.empty() ? 0 : 1;
}

}  // namespace

void add_eval_command(CLI::App& app, int& exit_status) {
  auto o = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("eval", "Train, search and score every frame of a BOP data set");
  command->add_option("dataset", o->dataset, "Folder in BOP layout")->required();
  command->add_option("--csv", o->csv, "BOP results file to write")->required();
  command->add_option("--evidence", o->evidence, "Also write what each score is made of, as CSV");
  command->add_option("--split", o->split, "Folder of the scenes")->capture_default_str();
  command->add_option("--scenes", o->scenes, "Scenes, such as 1,2,5-7; all when left out");
  command->add_option("--objects", o->objects, "Objects, such as 1,3; all when left out");
  command->add_option("--model-cache", o->model_cache,
                      "Folder that keeps trained models between runs");
  command->add_option("--threads", o->threads, "Threads of training and search")
      ->check(number_between(1, 256))
      ->capture_default_str();
  command->add_option("--json", o->json, "Write scores and the account of each frame as JSON");
  command->add_option("--report", o->report, "Folder for report.html");
  command->add_option("--max-results", o->settings.max_results, "Poses per frame, at most")
      ->check(number_between(1, 1024))
      ->capture_default_str();
  command->add_option("--min-score", o->settings.min_score, "Leave out poses with a lower score")
      ->check(number_between(0.0, 1.0))
      ->capture_default_str();
  command
      ->add_option("--threshold", o->threshold,
                   "Score at which F1 is reported besides the best one")
      ->check(number_between(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--layout", o->layout, "Memory layout of the feature maps")
      ->check(CLI::IsMember({"plain", "rearranged"}))
      ->capture_default_str();
  command->add_option("--isa", o->isa, "best, scalar, sse4, avx2 or avx512")->capture_default_str();
  add_template_options(*command, o->train);
  add_trial_options(*command, o->trials, false);
  command->callback([o, &exit_status] {
    take_settings(*o);
    exit_status = run(*o);
  });
}

}  // namespace binpick::app
