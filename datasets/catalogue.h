// Models by name: the table that says how to get each one, and its shape once it is fetched, generated or derived.
#pragma once

#include "datasets/load.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace hausbench {

// One [model.NAME] table of datasets/manifest.toml or of an experiment, checked.
struct ModelInfo {
    std::string name;
    std::string source;  // "generated", "debian", "npm", "file", "derived"
    std::string note;    // remark for readers, such as the published model that this one replaces
    std::string licence;
    // If the source is debian, npm or file: the file.
    std::string package, version, path, sha256, format;
    std::filesystem::path folder;  // a relative `path` starts from it
    // If the source is generated: the recipe. If it is derived: the operation (in `recipe`) and the model to apply it
    // to.
    std::string recipe, from;
    std::map<std::string, double> numbers;  // parameters of the recipe or operation
    // The shape itself, if the table contains it: an algebraic surface, or a list of coordinates.
    std::optional<Shape> written;
    bool of_corpus = false;  // listed in datasets/corpus.toml, or derived by a rule (corpus.h)

    bool by_rule() const { return of_corpus && source == "derived"; }
};

struct ResolvedModel {
    std::filesystem::path shape_file;  // for read_shape()
    std::string content_hash;
    LoadReport report;
    ShapeKind kind = ShapeKind::mesh;
    Index elements = 0, vertices = 0;
    double diagonal = 0, longest_side = 0;  // of the bounding box of its points
    std::string file_sha256 = {};           // of the file that was read; empty: no file
};

struct MissingModel {
    std::string reason;  // "package glmark2-data was not fetched: run `hausbench fetch`"
};

class Catalogue {
public:
    // Reads the models of the manifest, and of corpus.toml if it is in the same folder (corpus.h). Without a manifest
    // (an empty path) the catalogue is empty. `program` is the hausbench executable, which is started to read foreign
    // files (separate_process.h). Throws InputError for an unparsable manifest, an unknown key (the message has the
    // nearest known one), or a model that is derived from itself or from one that does not exist.
    Catalogue(const std::filesystem::path& manifest, std::filesystem::path cache, std::filesystem::path program);

    // Adds models that `file` defines. Pointers to earlier models become invalid. A new model replaces a model of the
    // same name that a rule of the corpus derived. Throws InputError for any other model of the same name, and for a
    // model that is derived from itself or from one that does not exist.
    void add(const std::filesystem::path& file, std::vector<ModelInfo> models);

    bool has(const std::string& name) const;
    const std::vector<ModelInfo>& models() const { return models_; }
    // Throws InputError, with the nearest known name, for an unknown name.
    const ModelInfo& find(const std::string& name) const;

    // Returns the names of the meshes of the corpus, sorted.
    const std::vector<std::string>& corpus() const { return corpus_; }

    // Creates the folders that resolve() writes to. Throws InputError if they cannot be created.
    void make_folders() const;

    // Protects the cache and the disk from models that an untrusted file defines. From now on new shapes are written to
    // this folder, and the cache is only read. Before resolve() makes a shape, it estimates the size of the folder with
    // this shape, and throws InputError if that is more than `most_bytes`.
    void keep_apart(std::filesystem::path folder, double most_bytes);

    // Calls `waiting` every few milliseconds while another process reads or makes a model.
    void while_waiting(std::function<void()> waiting) { waiting_ = std::move(waiting); }

    // Returns the shape of a model, which it makes unless it is cached, or the reason why the model is missing.
    //
    // Fetched files are looked up in CACHE/raw/<sha256>/<file name>, where datasets/fetch.py puts them, and their
    // SHA-256 is checked. Throws InputError if the hash differs (the message has both hashes), and for a file that is
    // not a regular file. Shapes are cached in CACHE/shapes/<key>.h5. The key is a hash of the recipe or operation and
    // of the bytes of all inputs, so that an outdated shape is never used after the manifest was edited. A cached shape
    // that cannot be used, such as a damaged one, is made again and replaced.
    std::variant<ResolvedModel, MissingModel> resolve(const std::string& name) const;

private:
    // The input of a model. If the model is derived, this is the shape file of the model that it is derived from, its
    // *origin*; if it comes from a file, this file; otherwise nothing.
    struct Input {
        std::filesystem::path file;
        std::string sha256;    // of the file that the model comes from; otherwise empty
        std::string identity;  // identifies the contents; part of the key of the new shape
        double size = 0;       // of a file: bytes; of a shape: points plus triangles
    };
    std::variant<Input, MissingModel> input_of(const ModelInfo& model) const;
    LoadedShape made(const ModelInfo& model, const Input& input) const;
    std::filesystem::path new_shape_file(const std::string& key) const;
    void expect_room(const ModelInfo& model, const Input& input) const;

    std::filesystem::path cache_, program_;
    std::filesystem::path apart_;  // the folder of keep_apart(); empty: not called
    double most_bytes_ = 0;
    std::function<void()> waiting_;
    std::vector<ModelInfo> models_;
    std::map<std::string, std::size_t> index_;  // from name to position in models_
    std::vector<std::string> corpus_;
};

}  // namespace hausbench
