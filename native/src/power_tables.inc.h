/* Coefficients of the power's series as sums of three doubles, each the rounding of what the ones
 * before leave: within 2^-159 of the exact value. CONSTANT (real_*.h) takes what its type can hold.
 */
static const REAL ln_2 = CONSTANT(0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56, 0x1.7b57a079a1934p-111);

/* 1/(2j + 1), from j = 0. */
static const REAL odd_reciprocal[] = {
    CONSTANT(0x1p0, 0, 0),
    CONSTANT(0x1.5555555555555p-2, 0x1.5555555555555p-56, 0x1.5555555555555p-110), /* 1/3 */
    CONSTANT(0x1.999999999999ap-3, -0x1.999999999999ap-57, 0x1.999999999999ap-111), /* 1/5 */
    CONSTANT(0x1.2492492492492p-3, 0x1.2492492492492p-57, 0x1.2492492492492p-111), /* 1/7 */
    CONSTANT(0x1.c71c71c71c71cp-4, 0x1.c71c71c71c71cp-58, 0x1.c71c71c71c71cp-112), /* 1/9 */
    CONSTANT(0x1.745d1745d1746p-4, -0x1.745d1745d1746p-59, 0x1.745d1745d1746p-114), /* 1/11 */
    CONSTANT(0x1.3b13b13b13b14p-4, -0x1.3b13b13b13b14p-58, 0x1.3b13b13b13b14p-112), /* 1/13 */
    CONSTANT(0x1.1111111111111p-4, 0x1.1111111111111p-60, 0x1.1111111111111p-116), /* 1/15 */
    CONSTANT(0x1.e1e1e1e1e1e1ep-5, 0x1.e1e1e1e1e1e1ep-61, 0x1.e1e1e1e1e1e1ep-117), /* 1/17 */
    CONSTANT(0x1.af286bca1af28p-5, 0x1.af286bca1af28p-59, 0x1.af286bca1af28p-113), /* 1/19 */
    CONSTANT(0x1.8618618618618p-5, 0x1.8618618618618p-59, 0x1.8618618618618p-113), /* 1/21 */
    CONSTANT(0x1.642c8590b2164p-5, 0x1.642c8590b2164p-60, 0x1.642c8590b2164p-115), /* 1/23 */
    CONSTANT(0x1.47ae147ae147bp-5, -0x1.eb851eb851eb8p-61, -0x1.47ae147ae147bp-115), /* 1/25 */
    CONSTANT(0x1.2f684bda12f68p-5, 0x1.2f684bda12f68p-59, 0x1.2f684bda12f68p-113), /* 1/27 */
    CONSTANT(0x1.1a7b9611a7b96p-5, 0x1.1a7b9611a7b96p-61, 0x1.1a7b9611a7b96p-117), /* 1/29 */
    CONSTANT(0x1.0842108421084p-5, 0x1.0842108421084p-60, 0x1.0842108421084p-115), /* 1/31 */
    CONSTANT(0x1.f07c1f07c1f08p-6, -0x1.f07c1f07c1f08p-61, 0x1.f07c1f07c1f08p-116), /* 1/33 */
    CONSTANT(0x1.d41d41d41d41dp-6, 0x1.075075075075p-60, 0x1.d41d41d41d41dp-114), /* 1/35 */
    CONSTANT(0x1.bacf914c1badp-6, -0x1.bacf914c1badp-60, 0x1.bacf914c1badp-114), /* 1/37 */
    CONSTANT(0x1.a41a41a41a41ap-6, 0x1.069069069069p-60, 0x1.a41a41a41a41ap-114), /* 1/39 */
    CONSTANT(0x1.8f9c18f9c18fap-6, -0x1.f3831f3831f38p-61, -0x1.8f9c18f9c18fap-116), /* 1/41 */
    CONSTANT(0x1.7d05f417d05f4p-6, 0x1.7d05f417d05f4p-62, 0x1.7d05f417d05f4p-118), /* 1/43 */
    CONSTANT(0x1.6c16c16c16c17p-6, -0x1.f49f49f49f49fp-61, -0x1.27d27d27d27d2p-115), /* 1/45 */
    CONSTANT(0x1.5c9882b931057p-6, 0x1.310572620ae4cp-61, 0x1.0572620ae4c41p-115), /* 1/47 */
};

/* 1/n!, from n = 0. */
static const REAL factorial_reciprocal[] = {
    CONSTANT(0x1p0, 0, 0),
    CONSTANT(0x1p0, 0, 0),
    CONSTANT(0x1p-1, 0, 0), /* 1/2! */
    CONSTANT(0x1.5555555555555p-3, 0x1.5555555555555p-57, 0x1.5555555555555p-111), /* 1/3! */
    CONSTANT(0x1.5555555555555p-5, 0x1.5555555555555p-59, 0x1.5555555555555p-113), /* 1/4! */
    CONSTANT(0x1.1111111111111p-7, 0x1.1111111111111p-63, 0x1.1111111111111p-119), /* 1/5! */
    CONSTANT(0x1.6c16c16c16c17p-10, -0x1.f49f49f49f49fp-65, -0x1.27d27d27d27d2p-119), /* 1/6! */
    CONSTANT(0x1.a01a01a01a01ap-13, 0x1.a01a01a01a01ap-73, 0x1.a01a01a01a01ap-133), /* 1/7! */
    CONSTANT(0x1.a01a01a01a01ap-16, 0x1.a01a01a01a01ap-76, 0x1.a01a01a01a01ap-136), /* 1/8! */
    CONSTANT(0x1.71de3a556c734p-19, -0x1.c154f8ddc6cp-73, 0x1.71de3a556c734p-127), /* 1/9! */
    CONSTANT(0x1.27e4fb7789f5cp-22, 0x1.cbbc05b4fa99ap-76, -0x1.c6d278883e8f5p-132), /* 1/10! */
    CONSTANT(0x1.ae64567f544e4p-26, -0x1.c062e06d1f209p-80, 0x1.c7880adcbc46ep-136), /* 1/11! */
    CONSTANT(0x1.1eed8eff8d898p-29, -0x1.2aec959e14c06p-83, 0x1.2fb0073dd2d9ep-139), /* 1/12! */
    CONSTANT(0x1.6124613a86d09p-33, 0x1.f28e0cc748ebep-87, -0x1.7b2c4c8a840bcp-141), /* 1/13! */
    CONSTANT(0x1.93974a8c07c9dp-37, 0x1.05d6f8a2efd1fp-92, 0x1.3aa3346236a5dp-147), /* 1/14! */
    CONSTANT(0x1.ae7f3e733b81fp-41, 0x1.1d8656b0ee8cbp-97, -0x1.6e142a138f825p-157), /* 1/15! */
    CONSTANT(0x1.ae7f3e733b81fp-45, 0x1.1d8656b0ee8cbp-101, -0x1.6e142a138f825p-161), /* 1/16! */
    CONSTANT(0x1.952c77030ad4ap-49, 0x1.ac981465ddc6cp-103, -0x1.588b72e53bc5fp-165), /* 1/17! */
    CONSTANT(0x1.6827863b97d97p-53, 0x1.eec01221a8b0bp-107, -0x1.568798662118bp-161), /* 1/18! */
    CONSTANT(0x1.2f49b46814157p-57, 0x1.2650f61dbdcb4p-112, -0x1.69502917cbf3bp-166), /* 1/19! */
    CONSTANT(0x1.e542ba4020225p-62, 0x1.ea72b4afe3c2fp-120, -0x1.44020dfd65c8cp-174), /* 1/20! */
    CONSTANT(0x1.71b8ef6dcf572p-66, -0x1.d043ae40c4647p-120, 0x1.486121e81d5fep-176), /* 1/21! */
    CONSTANT(0x1.0ce396db7f853p-70, -0x1.aebcdbd20331cp-124, -0x1.38a88578b4d75p-178), /* 1/22! */
    CONSTANT(0x1.761b41316381ap-75, -0x1.3423c7d91404fp-130, 0x1.e6135bfc1194ap-185), /* 1/23! */
    CONSTANT(0x1.f2cf01972f578p-80, -0x1.9ada5fcc1ab14p-135, 0x1.440ce7fd610dcp-189), /* 1/24! */
    CONSTANT(0x1.3f3ccdd165fa9p-84, -0x1.58ddadf344487p-139, -0x1.e8ed8001ad67ep-193), /* 1/25! */
    CONSTANT(0x1.88e85fc6a4e5ap-89, -0x1.71c37ebd1654p-143, 0x1.494676265a364p-197), /* 1/26! */
};
