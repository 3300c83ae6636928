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
#include "eval/fault_analysis.hpp"
#include "eval/fault_pictures.hpp"
#include "eval/fault_tables.hpp"
#include "eval/reliability_tables.hpp"
#include "eval/report_html.hpp"
#include "eval/report_pictures.hpp"
#include "eval/sweep.hpp"
#include "eval/sweep_tables.hpp"
#include "eval/table.hpp"
#include "exit_status.hpp"
#include "replace_file.hpp"
#include "setup_error.hpp"
#include "thread_pool.hpp"

namespace binpick::app {
namespace {

constexpr std::size_t kPicturesMax = 12, kCropsMax = 48;

struct Options {
  std::string dataset, csv, evidence, split = "test", sensor, scenes, objects, model_cache, json,
                                      report;
  std::string layout = "rearranged", isa = "best", modality = kModalityNames[0];
  int threads = default_thread_count();
  double threshold = DetectRequest{}.min_score;
  bool oracle = false;
  std::string sweep;  // empty: none
  std::vector<Disturbance> disturbances;
  EvalSettings settings;
  train::TrainOptions train;
  TrialPlan trials{.test_piles = 0};
  std::string distance_mm;  // empty: measured
  std::optional<DistanceRange> range;
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

std::vector<Disturbance> disturbances_of(const Options& o) {
  if (o.sweep.empty()) return {};
  try {
    return parse_disturbances(o.sweep);
  } catch (const std::invalid_argument& e) {
    throw CLI::ValidationError("--sweep", "'" + std::string(e.what()) +
                                              "': expected all, or noise, missing, contrast, "
                                              "light, focal, centre, separated by commas");
  }
}

void take_settings(Options& options) {
  DetectorParams& params = options.settings.search.params;
  params.layout = options.layout == "plain" ? MapLayout::kPlain : MapLayout::kRearranged;
  params.isa = parse_isa("--isa", options.isa);
  options.settings.search.modality = parse_modality("--modality", options.modality);
  options.disturbances = disturbances_of(options);
  if (!options.distance_mm.empty()) {
    const auto [min_mm, max_mm] = parse_range("--distance-mm", options.distance_mm);
    options.range = DistanceRange{min_mm, max_mm};
  }
}

std::vector<std::pair<std::string, std::string>> facts_of(const Options& o) {
  char score[32];
  std::snprintf(score, sizeof score, "%g", o.settings.search.min_score);
  std::vector<std::pair<std::string, std::string>> facts = {
      {"data set", o.dataset},
      {"split", o.split},
      {"scenes", o.scenes.empty() ? "all" : o.scenes},
      {"objects", o.objects.empty() ? "all" : o.objects},
      {"threads", std::to_string(o.threads)},
      {"layout", o.layout},
      {"instruction set", o.isa},
      {"modality", o.modality},
      {"results at most", std::to_string(o.settings.search.max_results)},
      {"score at least", score}};
  if (!o.sensor.empty()) facts.emplace_back("sensor", o.sensor);
  return facts;
}

// All that the passes over the frames share.
struct Session {
  explicit Session(const Options& o)
      : options(o),
        talk(terminal_talk()),
        dataset(o.dataset, o.split, o.sensor),
        plan(make_eval_plan(
            dataset, {parse_id_list("--scenes", o.scenes), parse_id_list("--objects", o.objects)})),
        parts(load_parts(dataset, plan.objects())),
        geometry(geometry_of(parts)),
        pool(o.threads) {
    score_options.fixed_threshold = o.threshold;
    score_options.objects = plan.objects();
  }

  const Options& options;
  const EvalTalk talk;
  const drivers::BopDataset dataset;
  const EvalPlan plan;
  const PartLibrary parts;
  const std::map<int, PartGeometry> geometry;
  ScoreOptions score_options;
  ThreadPool pool;
};

// What the passes found.
struct Outcome {
  EvalRun run;
  std::vector<ModelOrigin> models;
  std::vector<TargetFinding> targets;  // of the oracle
  Sweep sweep;
};

// Camera groups one after the other, each with its own models and detector. The oracle's pass knows
// the truth; it comes after the search, and changes nothing of it.
Outcome search(Session& s) {
  Outcome out{{}, {}, {}, Sweep(s.options.disturbances)};
  out.run.faults = s.plan.faults;
  const ModelCache cache(s.options.model_cache);
  BopResultsWriter writer(s.options.csv);
  std::optional<EvidenceWriter> evidence;
  if (!s.options.evidence.empty()) evidence.emplace(s.options.evidence);
  const EvalOutput output{&writer, evidence ? &*evidence : nullptr};
  const OracleRequest oracle{s.dataset,  s.plan,          s.parts,
                             s.geometry, s.score_options, s.options.settings.search};
  for (const CameraGroup& group : s.plan.cameras) {
    const ModelSet models = make_model_set({s.dataset, s.plan, group, s.parts, cache,
                                            s.options.train, s.options.trials, s.options.range},
                                           s.pool, s.talk, out.run.faults);
    out.models.insert(out.models.end(), models.origins().begin(), models.origins().end());
    run_group(s.dataset, s.plan, group, models, s.options.settings, s.pool, s.talk, output,
              out.run);
    if (s.plan.truth.empty()) continue;
    if (s.options.oracle)
      run_oracle(oracle, group, models, s.pool, s.talk, out.targets, out.run.faults);
    out.sweep.run_group(s.dataset, s.plan, group, models, s.options.settings, s.pool, s.talk);
  }
  writer.close();
  if (evidence) evidence->close();
  return out;
}

std::string report_path(const Options& options) {
  return (std::filesystem::path(options.report) / "report.html").string();
}

void write_report(const Session& s, ReportContent content, const std::vector<ResultRow>& rows) {
  content.pictures = worst_pictures(s.dataset, s.plan, s.parts, content.score, rows, kPicturesMax);
  write_text(report_path(s.options), report_html(content));
}

std::vector<SweepCurves> curves_of(const Session& s, const Outcome& outcome,
                                   const ScoreReport& score) {
  if (s.options.sweep.empty() || s.plan.truth.empty()) return {};
  std::vector<SweepCurves> curves = score_sweep(outcome.sweep, score, s.geometry, s.plan.truth);
  curves.push_back(visibility_curves(score, s.plan.truth, outcome.run.rows));
  curves.push_back(threshold_curves(score));
  return curves;
}

// Before long work: whether there is a place for its results.
void check_outputs(const Options& options) {
  if (!options.json.empty()) check_replaceable(options.json);
  if (options.report.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(options.report, error);
  if (error) throw SetupError(options.report + ": cannot be made: " + error.message());
  check_replaceable(report_path(options));
}

int run(const Options& options) {
  check_outputs(options);
  Session s(options);
  for (const std::string& fault : s.plan.faults) s.talk.note(fault);
  const Outcome outcome = search(s);
  const EvalRun& run = outcome.run;

  const ScoreReport score =
      score_results(s.geometry, s.plan.truth, run.rows, run.times_s(), s.score_options);
  const std::vector<RunLine> lines = summarize_parts(run, score);
  if (s.plan.truth.empty()) {
    std::printf("The data set has no truth for these frames: there are times, but no scores.\n");
  } else {
    std::printf("%s\n", score_table(score).c_str());
  }
  const std::vector<Reliability> reliability = find_reliability(score, run.rows, options.threshold);
  if (!reliability.empty()) std::printf("%s\n", reliability_table(reliability).c_str());
  std::printf("%s\n%s", stage_table(lines).c_str(), level_table(lines).c_str());
  std::vector<PartFaults> faults;
  if (options.oracle && !s.plan.truth.empty()) {
    faults = analyse_faults(score, s.plan.truth, s.geometry, run.rows, outcome.targets);
    std::printf("\n%s", fault_table(faults).c_str());
  }
  const std::vector<SweepCurves> curves = curves_of(s, outcome, score);
  if (!curves.empty()) std::printf("\n%s", sweep_table(curves, outcome.sweep.noise_mm()).c_str());
  const auto facts = facts_of(options);
  if (!options.json.empty()) {
    nlohmann::json out = eval_to_json(score, run, outcome.models, facts);
    out["reliability"] = reliability_to_json(reliability);
    if (!faults.empty()) out["oracle"] = faults_to_json(faults, run.rows);
    if (!curves.empty()) out["sweep"] = sweep_to_json(curves, outcome.sweep.noise_mm());
    write_text(options.json, out.dump(1) + "\n");
  }
  if (!options.report.empty()) {
    ReportContent content;
    content.title = "binpick on " + std::filesystem::path(options.dataset).filename().string();
    content.facts = facts;
    content.score = score;
    content.lines = lines;
    content.models = outcome.models;
    content.faults = run.faults;
    content.reach = reach_section_html(faults);
    content.causes = cause_section_html(faults, s.plan.truth, run.rows);
    content.reliability = reliability_section_html(reliability);
    content.curves = sweep_section_html(curves, outcome.sweep.noise_mm());
    content.fault_pictures =
        fault_pictures(s.dataset, s.plan, s.parts, faults, run.rows, kCropsMax);
    write_report(s, std::move(content), run.rows);
  }
  if (!run.faults.empty())
    s.talk.note(std::to_string(run.faults.size()) + " fault(s), named above");
  if (run.faults.empty()) return kDone;
  return run.frames.empty() ? kCannotStart : kFailure;
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
  command->add_option("--sensor", o->sensor, "Of a data set with several sensors: the one to use");
  command->add_option("--scenes", o->scenes, "Scenes, such as 1,2,5-7; all when left out");
  command->add_option("--objects", o->objects, "Objects, such as 1,3; all when left out");
  command->add_option("--model-cache", o->model_cache,
                      "Folder that keeps trained models between runs");
  command->add_option(
      "--distance-mm", o->distance_mm,
      "Distances to train for, MIN:MAX, as frames without depth need it; measured in "
      "the depth images when left out");
  command->add_option("--threads", o->threads, "Threads of training and search")
      ->check(number_between(1, 256))
      ->capture_default_str();
  command->add_option("--json", o->json, "Write scores and the account of each frame as JSON");
  command->add_option("--report", o->report, "Folder for report.html");
  command->add_flag("--oracle", o->oracle,
                    "Also begin every part at its true pose, and name the cause of every fault");
  command
      ->add_option("--sweep", o->sweep,
                   "Also search frames made worse, and give curves of F1: all (when nothing "
                   "follows), or some of noise, missing, contrast, light, focal, centre, separated "
                   "by commas; each is 3 to 5 further runs, --scenes bounds their time")
      ->expected(0, 1)
      ->default_str("all");
  command->add_option("--max-results", o->settings.search.max_results, "Poses per frame, at most")
      ->check(number_between(1, 1024))
      ->capture_default_str();
  command
      ->add_option("--min-score", o->settings.search.min_score,
                   "Leave out poses with a lower score")
      ->check(number_between(0.0, 1.0))
      ->capture_default_str();
  command
      ->add_option("--threshold", o->threshold,
                   "Score at which F1 and precision are reported besides the best one")
      ->check(number_between(0.0, 1.0))
      ->capture_default_str();
  command
      ->add_option("--modality", o->modality,
                   "Images to search in: " + modality_list() + "; automatic: what a frame has")
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
