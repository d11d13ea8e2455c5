#include "routes_papers.h"

namespace coppice::bench {
namespace {

PrintedTetrahedra zhu2013(std::uint64_t tetrahedra, std::uint64_t vertices, std::uint64_t triangles,
                          double bpc, double tetz, double sub, double field, double extract, double total) {
    return {tetrahedra,
            vertices,
            triangles,
            {{"BPC", bpc}, {"Tetz", tetz}, {"TetSub", sub}, {"CalcField", field}, {"ExtrIso", extract}},
            total};
}

PrintedTetrahedra zhu2015(std::uint64_t tetrahedra, std::uint64_t vertices, std::uint64_t triangles,
                          double plyh, double tetz, double sub, double field, double extract, double total) {
    return {tetrahedra,
            vertices,
            triangles,
            {{"Plyh", plyh}, {"Tetz", tetz}, {"TetSub", sub}, {"FieldCalc", field}, {"IsoExtr", extract}},
            total};
}

PrintedQuads zhu2015_quads(std::uint64_t quads, double plyh, double subdivision, double approximation,
                           double total) {
    return {quads, {{"Plyh", plyh}, {"SurfSubd", subdivision}, {"Appr", approximation}}, total};
}

}  // namespace

std::vector<PaperTree> paper_trees() {
    return {
        {"Rhus",
         "Zhu2013",
         288,
         false,
         zhu2013(1'056'768, 905'228, 362'740, 0.349, 0.084, 0.029, 0.310, 0.018, 0.790),
         {{220, 10'648'000, 168'166, 5.020, 0.128, 5.148},
          {320, 32'768'000, 364'068, 14.264, 0.411, 14.675},
          {330, 35'937'000, 381'284, 14.307, 0.429, 14.736}},
         {}},
        {"Eucalyptus",
         "Zhu2013",
         204,
         false,
         zhu2013(747'008, 639'841, 235'241, 0.205, 0.056, 0.027, 0.151, 0.014, 0.453),
         {{220, 10'648'000, 156'216, 3.556, 0.130, 3.686},
          {320, 35'937'000, 243'496, 7.025, 0.267, 7.292},
          {330, 21'952'000, 326'968, 10.088, 0.436, 10.524}},
         {}},
        {"Acer japonicum",
         "Zhu2015",
         288,
         true,
         zhu2015(1'180'160, 1'010'845, 388'951, 0.015, 0.063, 0.065, 0.344, 0.011, 0.498),
         {},
         {zhu2015_quads(17'088, 0.015, 0.016, 0.142, 0.173)}},
        {"Ulmus",
         "Zhu2015",
         290,
         true,
         zhu2015(1'102'336, 944'239, 369'690, 0.014, 0.062, 0.068, 0.316, 0.010, 0.470),
         {},
         {zhu2015_quads(17'160, 0.014, 0.018, 0.154, 0.186)}},
        {"Quercus",
         "Zhu2015",
         129,
         true,
         zhu2015(464'384, 397'792, 161'540, 0.008, 0.032, 0.042, 0.070, 0.005, 0.157),
         {},
         {zhu2015_quads(7'704, 0.008, 0.013, 0.031, 0.052)}},
    };
}

}  // namespace coppice::bench
