// Models by name: the origin of each, and its shape once it is fetched, generated or derived.
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
    std::string note;    // remark, such as the model that it stands in for
    std::string licence;
    // debian, npm, file
    std::string package, version, path, sha256, format;
    std::filesystem::path folder;  // folder that a relative path starts from
    // generated: a recipe; derived: an operation, and the model `from`
    std::string recipe, from;
    std::map<std::string, double> numbers;  // parameters of the recipe or operation
    // The shape, if its table contains it: recipe "surface", or listed coordinates.
    std::optional<Shape> written;
    bool of_corpus = false;  // in datasets/corpus.toml, or made by a rule of corpus.h

    bool by_rule() const { return of_corpus && source == "derived"; }
};

struct ResolvedModel {
    std::filesystem::path shape_file;  // for read_shape()
    std::string content_hash;
    LoadReport report;
    ShapeKind kind = ShapeKind::mesh;
    Index elements = 0, vertices = 0;
    double diagonal = 0, longest_side = 0;  // of the box of its points
    std::string file_sha256 = {};           // of the file that was read; empty: none
};

struct MissingModel {
    std::string reason;  // "package glmark2-data was not fetched: run `hausbench fetch`"
};

class Catalogue {
public:
    // An empty path means no models. Also reads corpus.toml beside the manifest, if there is one (corpus.h). `program`
    // is the hausbench executable that reads foreign files (separate_process.h). Throws InputError for an unparsable manifest,
    // an unknown key (names the nearest), or a derived model whose origin does not exist or depends on itself.
    Catalogue(const std::filesystem::path& manifest, std::filesystem::path cache, std::filesystem::path program);

    // Adds models that `file` defines; pointers to earlier models become invalid. A new model replaces one
    // that a rule of the corpus made. Throws InputError if any other model has the same name, and as above.
    void add(const std::filesystem::path& file, std::vector<ModelInfo> models);

    bool has(const std::string& name) const;
    const std::vector<ModelInfo>& models() const { return models_; }
    // Throws InputError, with the nearest known name, for an unknown name.
    const ModelInfo& find(const std::string& name) const;

    // Returns the names of the meshes of the corpus, sorted.
    const std::vector<std::string>& corpus() const { return corpus_; }

    // Creates the folders that resolve() writes to. Throws InputError if they cannot be created.
    void make_folders() const;

    // From now on writes new shapes to this folder and only reads the cache. resolve() throws
    // InputError before it makes a shape if the folder would then hold more than an estimated
    // `most_bytes`. For models that a foreign file defines.
    void keep_apart(std::filesystem::path folder, double most_bytes);

    // Returns the shape of a model, or the reason why it is missing. Fetched files are looked up in
    // CACHE/raw/<sha256>/<file name>, where datasets/fetch.py puts them, and their SHA-256 is checked; a
    // mismatch throws InputError with the model and both hashes, and so does a file that is not a regular
    // file. Shapes are cached in CACHE/shapes/<key>.h5; the key is a hash of the recipe, the operation
    // and the bytes of all inputs, so that a stale shape is never used after the manifest was edited.
    std::variant<ResolvedModel, MissingModel> resolve(const std::string& name) const;

private:
    // The input of a model: the shape of its origin if it is derived, else the file that is read, if there is one.
    struct Input {
        std::filesystem::path file;
        std::string sha256;    // if a file is read
        std::string identity;  // identifies the contents
        double size = 0;       // a file: bytes; a shape: points plus triangles
    };
    std::variant<Input, MissingModel> input_of(const ModelInfo& model) const;
    LoadedShape made(const ModelInfo& model, const Input& input) const;
    std::filesystem::path shape_file(const std::string& key) const;
    void expect_room(const ModelInfo& model, const Input& input) const;

    std::filesystem::path cache_, program_;
    std::filesystem::path apart_;  // see keep_apart()
    double most_bytes_ = 0;
    std::vector<ModelInfo> models_;
    std::map<std::string, std::size_t> index_;  // from name to position in models_
    std::vector<std::string> corpus_;
};

}  // namespace hausbench
