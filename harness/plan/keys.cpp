#include "harness/plan/keys.h"

#include "harness/plan/experiment.h"

#include <fmt/format.h>

#include <algorithm>

namespace hausbench {

std::vector<std::string> KeyTable::names() const {
    std::vector<std::string> all;
    for (const Key& key : keys) all.push_back(key.name);
    return all;
}

const KeyTable& top_keys() {
    static const KeyTable table = [] {
        const Experiment defaults;
        return KeyTable{
            "",
            {{"title", "", "required; shown above the table"},
             {"paper", "", "key in `papers.bib`"},
             {"tolerances", "",
              "list; each value is a case of its own. Required here, in each `[[scene]]` or in each `[[solver]]`"},
             {"of", fmt::format("\"{}\"", defaults.of),
              "unit of `tolerances`, `floor` and `cutoff`: `diagonal` or `longest` (side) of A's box as loaded, "
              "`absolute`, or `lower` (a fraction of the lower bound; `floor` and `cutoff` are then lengths)"},
             {"quantity", fmt::format("\"{}\"", to_string(defaults.quantity)),
              "`directed`: h(A,B); `symmetric`: H(A,B); `penetration`: depth of two closed meshes in each other "
              "(solver `penetration`); `distribution`: statistics of the distance (solvers "
              "`distribution` and `monte_carlo`)"},
             {"statistics", "",
              fmt::format("for `distribution`: list of `{}` ", fmt::join(statistic_examples(), "`, `")) +
                  "(the share at most that far away), each perhaps followed by `target`, `larger`, `mean_of_both`, "
                  "`harmonic_mean` or `pooled` ([conventions.md](conventions.md)); each is a case of its own. The "
                  "tolerance "
                  "of a share is the number in `tolerances`, whatever `of` says"},
             {"weigh", fmt::format("\"{}\"", to_string(defaults.weigh)),
              "what statistics count: `area`, or `number` of vertices"},
             {"floor", fmt::format("{}", defaults.floor),
              "a solver may stop once the distance is known to be at most this"},
             {"cutoff", "",
              "a solver may stop once the distance is known to be above this. `floor` = `cutoff` asks \"is h above "
              "it?\""},
             {"threads", fmt::format("{}", defaults.threads), "threads that a solver may use, if it supports them"},
             {"budget", "", "limit of the solver's own unit of work; its source file names the unit"},
             {"repeats", fmt::format("{}", defaults.repeats), "timed repeats in each round"},
             {"rounds", fmt::format("{}", defaults.rounds), "fresh processes; verdicts on times need 6 or more"},
             {"trace", fmt::format("{}", defaults.trace), "records the bounds over time"},
             {"fields", fmt::format("{}", defaults.fields),
              "in an untimed run: cuts A finely enough to show its distance to B, with distance and nearest element "
              "of each vertex, and the solver's values of each element (`/fields` in the result). Not for surfaces"},
             {"stages", fmt::format("{}", defaults.stages),
              "in an untimed run: seconds of each stage, as numbers in `extras`"},
             {"reference", fmt::format("{}", defaults.reference),
              "computes one certified answer for each scene, pose and quantity, to which all rows are compared"},
             {"limits", "", "table, see below"},
             {"plugins", "", "list of plug-in libraries, relative to the experiment"},
             {"expected_unsound", "",
              "labels of solvers whose wrong answers are a result here; solvers with `known_wrong` need not be listed"},
             {"scene", "", "tables `[[scene]]`, at least one"},
             {"solver", "", "tables `[[solver]]`, at least one"},
             {"claim", "", "tables `[[claim]]`"},
             {"model", "", "tables `[model.NAME]`: models of this file"},
             {"profile", "", "tables `[profile.NAME]`: keys that replace keys of the top level in that profile"}}};
    }();
    return table;
}

const KeyTable& limit_keys() {
    static const KeyTable table = [] {
        const Experiment defaults;
        const Limits& limits = defaults.limits;
        return KeyTable{
            "[limits]",
            {{"case_seconds", fmt::format("{}", limits.case_seconds),
              "time for the solver's answer; then the status is `timeout`"},
             {"prepare_seconds", fmt::format("{}", limits.prepare_seconds), "time to build its structures"},
             {"memory_mb", fmt::format("{}", limits.memory_bytes >> 20), "memory of the solver's process, in MiB"},
             {"reference_seconds", fmt::format("{}", defaults.reference_seconds),
              "time for each certified answer to compare with"}}};
    }();
    return table;
}

const KeyTable& scene_keys() {
    static const KeyTable table = {
        "[[scene]]",
        {{"name", "", "unique; with `severity` and `each`, `{}` stands for the value or model"},
         {"source", "", "shape A: a model of the manifest or of this file, a path, or a shape described in place"},
         {"target", "", "shape B, likewise"},
         {"sources", "",
          "list: a matrix of pairs, in which each shape is loaded and prepared once. Its scenes are called \"NAME: "
          "cow to hippo\""},
         {"targets", "`sources`", "the other list of the matrix"},
         {"search", "",
          "in a matrix, `\"nearest\"`: only the nearest target of each source matters. The targets form a chain in "
          "this order, and each has the least upper bound so far as its cutoff (column `cutoff_used`). Pairs of a "
          "model with itself are left out. Not with a motion or `warm`"},
         {"note", "", "printed with the table, such as which model stands in for which"},
         {"exact", "",
          "exact value of the quantity, if known; not for moving scenes. With `severity`: one number, `\"{}\"`, or a "
          "list"},
         {"motion", "static", "motion of A, see below"},
         {"target_motion", "static", "motion of B. If both move, they need the same number of poses"},
         {"tolerances", "of the top level", "tolerances of this scene"},
         {"profiles", "all profiles", "list: the scene belongs to these profiles only"},
         {"each", "",
          "one scene per model: `\"corpus\"` (366 real meshes), `\"whole_corpus\"` (806, broken files included), or a "
          "list of names"},
         {"severity", "",
          "one scene per value, such as `[1, 1e4, 1e8]`; fills the columns `severity` and `family`. `\"{}\"` may "
          "stand in every text and number of the scene"},
         {"family", "`name` without `{}`", "name of the sweep over `severity`"},
         {"recording", "", "file: one scene per pair of objects that overlap in a recorded simulation, see below"},
         {"every", "1", "takes every n-th frame of the recording"},
         {"frames", "all frames", "list: takes these frames only"}}};
    return table;
}

namespace {

const std::vector<KeyTable>& motion_tables() {
    static const std::vector<KeyTable> tables = {
        {"static", {{"kind", "", "`\"static\"`: the shape as loaded"}}},
        {"translation",
         {{"kind", "", "`\"translation\"`: pose i is moved by `from` + i (`to` - `from`) / (`steps` - 1)"},
          {"from", "", "three numbers"},
          {"to", "", "three numbers"},
          {"steps", "10", "number of poses; 1: only `from`"},
          {"of", "\"diagonal\"", "unit: `diagonal` or `longest` (side) of the moving shape's box, or `absolute`"}}},
        {"rotation",
         {{"kind", "",
           "`\"rotation\"`: pose i is turned by i `degrees` / (`steps` - 1), by the right-hand rule. For full turns "
           "the last pose would repeat the first, so it is i `degrees` / `steps`"},
          {"axis", "", "three numbers; the axis goes through the centre of the box as loaded"},
          {"degrees", "", "angle of the last pose"},
          {"steps", "10", "number of poses"}}},
        {"poses",
         {{"kind", "", "`\"poses\"`: pose i is line i of a text file"},
          {"file", "",
           "each line has twelve numbers, a 3 x 3 matrix by rows, then the translation; `#` begins a comment"}}}};
    return tables;
}

}  // namespace

const std::vector<std::string>& motion_kinds() {
    static const std::vector<std::string> kinds = [] {
        std::vector<std::string> all;
        for (const KeyTable& table : motion_tables()) all.push_back(table.title);
        return all;
    }();
    return kinds;
}

const KeyTable& motion_keys(const std::string& kind) {
    return *std::find_if(motion_tables().begin(), motion_tables().end(),
                         [&](const KeyTable& table) { return table.title == kind; });
}

const KeyTable& solver_keys() {
    static const KeyTable table = {
        "[[solver]]",
        {{"name", "", "see `hausbench list`; `external` runs another program, see [plugins.md](plugins.md)"},
         {"label", "`name`", "name of its rows and in figures"},
         {"parameters", "",
          "table of the solver's parameters (`hausbench list NAME`); a list of values makes one case for each"},
         {"quantity", "of the top level", "quantity of this solver"},
         {"statistics", "of the top level", "statistics of this solver"},
         {"weigh", "of the top level", "what its statistics count"},
         {"threads", "of the top level", "threads of this solver"},
         {"tolerances", "of the top level", "tolerances of this solver"},
         {"scenes", "all scenes", "list: it runs on these scenes only"},
         {"warm", "false", "each pose starts from the state of the one before, if the solver supports that"},
         {"profiles", "all profiles", "list: the solver belongs to these profiles only"}}};
    return table;
}

const KeyTable& claim_keys() {
    static const KeyTable table = {
        "[[claim]]",
        {{"solver", "", "label of the solver that the claim is about"},
         {"faster_than", "", "label of another"},
         {"by", "1", "factor"},
         {"on", "\"average\"", "`average`: geometric mean over the cases; `every`: each case"}}};
    return table;
}

std::vector<KeyTable> key_tables() {
    std::vector<KeyTable> all = {top_keys(), limit_keys(), scene_keys()};
    for (const std::string& kind : motion_kinds()) {
        all.push_back(motion_keys(kind));
        all.back().title = "motion = { kind = \"" + kind + "\" }";
    }
    all.push_back(solver_keys());
    all.push_back(claim_keys());
    return all;
}

}  // namespace hausbench
