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
    std::string note;    // description, and which model of a paper it stands in for
    std::string licence;
    // debian, npm, file
    std::string package, version, path, sha256, format;
    std::filesystem::path folder;  // from which a relative path of a file counts
    // generated: recipe; derived: operation and `from`
    std::string recipe, from;
    std::map<std::string, double> numbers;  // parameters of the recipe or operation
    // The shape in its table: recipe "surface", or listed coordinates.
    std::optional<Shape> written;
    bool of_corpus = false;  // in datasets/corpus.toml, or made by its rules (corpus.h)

    bool by_rule() const { return of_corpus && source == "derived"; }
};

struct ResolvedModel {
    std::filesystem::path shape_file;  // read_shape() reads it
    std::string content_hash;
    LoadReport report;
    ShapeKind kind = ShapeKind::mesh;
    Index elements = 0, vertices = 0;
    double diagonal = 0, longest_side = 0;  // of the box of its points
    std::string file_sha256 = {};           // of the file that it was read from; empty: none
};

struct MissingModel {
    std::string reason;  // "package glmark2-data was not fetched: run `hausbench fetch`"
};

class Catalogue {
public:
    // An empty path: no models. A corpus.toml beside the manifest is read as well (corpus.h). `program` is the hausbench executable that reads foreign files (separate_process.h). Throws InputError for an unparsable
    // manifest, an unknown key (names the nearest), a derived model whose origin does not exist or depends on itself.
    Catalogue(const std::filesystem::path& manifest, std::filesystem::path cache, std::filesystem::path program);

    // More models, which `file` defines; pointers to those before become invalid. One that a rule of the corpus made is
    // replaced. Throws InputError for any other name that there is, and as above.
    void add(const std::filesystem::path& file, std::vector<ModelInfo> models);

    bool has(const std::string& name) const;
    const std::vector<ModelInfo>& models() const { return models_; }
    // Throws InputError that names the nearest.
    const ModelInfo& find(const std::string& name) const;

    // The meshes of the corpus, by name, sorted.
    const std::vector<std::string>& corpus() const { return corpus_; }

    // Creates the folders that resolve() writes to. Throws InputError if they cannot be created.
    void make_folders() const;

    // From now on new shapes go to this folder instead of the cache, which is only read, and resolve() throws InputError before it makes
    // a shape with which they would take more than `most_bytes`, as estimated: for models that a foreign file defines.
    void keep_apart(std::filesystem::path folder, double most_bytes);

    // Throws InputError for a model's file that is not a regular file. Fetched files are looked for in CACHE/raw/<sha256>/<file name> (datasets/fetch.py puts them there) and their
    // SHA-256 is checked; a mismatch throws InputError with the model and both hashes. Shapes are cached in
    // CACHE/shapes/<key>.h5, where key is a hash of the recipe, the operation and the bytes of all inputs, so a stale shape
    // is never used after an edit of the manifest.
    std::variant<ResolvedModel, MissingModel> resolve(const std::string& name) const;

private:
    // The input of a model: for a derived one the shape of its origin, otherwise the file that is read, if any.
    struct Input {
        std::filesystem::path file;
        std::string sha256;    // of a file that is read
        std::string identity;  // of its contents
        double size = 0;       // of a file in bytes, of a shape in points and triangles
    };
    std::variant<Input, MissingModel> input_of(const ModelInfo& model) const;
    LoadedShape made(const ModelInfo& model, const Input& input) const;
    std::filesystem::path shape_file(const std::string& key) const;
    void expect_room(const ModelInfo& model, const Input& input) const;

    std::filesystem::path cache_, program_;
    std::filesystem::path apart_;  // see keep_apart()
    double most_bytes_ = 0;
    std::vector<ModelInfo> models_;
    std::map<std::string, std::size_t> index_;  // of models_, by name
    std::vector<std::string> corpus_;
};

}  // namespace hausbench
