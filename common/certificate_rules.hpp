// What a certificate of the link must be, at start and in each handshake. Only files that know
// OpenSSL include it.
#pragma once

#include <openssl/x509.h>
#include <openssl/x509_vfy.h>

#include "common/certificates.hpp"

namespace farhand {

// In DER, of a side; an authority's is not sent. With it each flight of a handshake fits one
// datagram: of several, in another order than sent, OpenSSL drops a part for good, since what is
// sent again has the same record numbers.
inline constexpr int kMaxCertificateBytes = 800;

// OpenSSL's checks of the other side's certificate: signed by the authority itself, for `role`,
// nothing weaker than 112 bits. False if OpenSSL cannot.
bool expect_role(X509_VERIFY_PARAM* of, DtlsRole role) noexcept;

// OpenSSL takes a certificate that names no usage for any; we do not.
bool names_role(X509* certificate, DtlsRole role) noexcept;

// It says kObserverUsage, or what it says cannot be read.
bool names_observer(const X509* certificate) noexcept;

}  // namespace farhand
